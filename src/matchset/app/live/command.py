"""`matchset live`: the page in a browser.

Imports that take long stand inside the function, so that `matchset --help` answers at once.
"""

from typing import Annotated

import msgspec
import typer

from matchset.app.cli_options import StreamNumber, TurnOptions
from matchset.numeric.extras import advice

LIVE_EPILOG = """
[bold]Examples[/bold]

  matchset live 0

  matchset live ball.mp4 --pick 346,151

  matchset live 0 --lan

Exit codes: 0 ended by Ctrl-C or SIGTERM (files are whole), 2 bad input or options.
"""

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


def live(options: LiveOptions) -> int:
    """See a camera or a video in the browser, click a ball, read where it is."""
    try:
        import starlette  # noqa: F401
        import uvicorn  # noqa: F401
        import websockets  # noqa: F401
    except ImportError as error:
        raise ValueError(f"the live page needs the extra web ({error.name} is missing): {advice('web')}") from None
    from matchset.app.live.serve import serve

    return serve(options)
