"""The options of commands that share what they see with other computers: `SharingOptions`.

This module is loaded for every `matchset --help`.
"""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import msgspec
import typer

if TYPE_CHECKING:
    from matchset.sharing.share import Share

Name = Annotated[
    str | None,
    typer.Option("--share", metavar="NAME", help="Tell others on this computer what is seen here, under this name."),
]
Network = Annotated[bool, typer.Option("--share-network", help="Share with all on the same network, too.")]
Endpoints = Annotated[
    list[str] | None,
    typer.Option("--share-with", metavar="ENDPOINT", help="Share with who listens there, too: tcp/HOST:PORT; several."),
]
Key = Annotated[str | None, typer.Option("--share-key", metavar="KEY", help="Only those with the same one share.")]
Configuration = Annotated[
    Path | None,
    typer.Option("--share-config", metavar="FILE.json5", help="Zenoh's own settings: passwords, certificates."),
]
Ros2 = Annotated[
    int | None,
    typer.Option(
        "--ros2", metavar="DOMAIN", help="Send it as messages of ROS 2 (rmw_zenoh), too, in this ROS_DOMAIN_ID."
    ),
]


class SharingOptions(msgspec.Struct, frozen=True, kw_only=True):
    """Whether and how is shared; each option is explained where its type is defined."""

    share: Name = None
    share_network: Network = False
    share_with: Endpoints = None
    share_key: Key = None
    share_config: Configuration = None
    ros2: Ros2 = None

    def opened(self) -> "Share | None":
        """Begin to share; None if that is not asked for.

        Raises
        ------
        ValueError
            If options need another one, or a value cannot be.
        LinkError
            If Zenoh is not installed, or an endpoint cannot be used.
        """
        if self.share is None:
            asked = [f"--{name.replace('_', '-')}" for name in self.__struct_fields__ if self._differs(name)]
            if asked:
                raise ValueError(f"{asked[0]} is for what is shared: add --share NAME")
            return None
        from matchset.sharing.share import DEFAULT_KEY, Share

        return Share(
            self.share,
            key=self.share_key or DEFAULT_KEY,
            discovery="network" if self.share_network else None,
            connect=list(self.share_with or ()),
            config=self.share_config,
            ros_domain=self.ros2,
        )

    def _differs(self, name: str) -> bool:
        return bool(getattr(self, name) not in (None, False))
