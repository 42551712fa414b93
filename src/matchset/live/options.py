"""The options of `matchset live`: `LiveOptions`. This module is loaded for every `matchset --help`."""

from typing import Annotated

import msgspec
import typer

from matchset.app.cli_options import FieldsName, StreamNumber, TurnOptions
from matchset.app.sharing_options import SharingOptions

Source = Annotated[
    str | None,
    typer.Argument(help="Camera number, video file, URL, or flight.toml of real vehicles. None: a menu."),
]


Port = Annotated[int, typer.Option("--port", min=0, max=65535, help="Port; where it is in use, the next one.")]


Browser = Annotated[bool, typer.Option("--browser/--no-browser", help="Open the page.")]


Lan = Annotated[bool, typer.Option("--lan", help="For other computers and phones: prints an address with a token.")]


Pick = Annotated[str | None, typer.Option("--pick", metavar="X,Y", help="Follow what is there in the first picture.")]


class LiveOptions(msgspec.Struct, frozen=True, kw_only=True):
    """The options of `matchset live`; each is explained where its type is defined."""

    source: Source = None
    port: Port = 8123
    browser: Browser = True
    lan: Lan = False
    pick: Pick = None
    mounted: TurnOptions = TurnOptions()
    stream: StreamNumber = None
    fields: FieldsName = "frames"
    sharing: SharingOptions = SharingOptions()
