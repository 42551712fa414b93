"""`matchset live`: the page in a browser.

Imports that take long stand inside the function, so that `matchset --help` answers at once.
"""

from matchset.live.options import LiveOptions
from matchset.numeric.imports import advice

LIVE_EPILOG = """
[bold]Examples[/bold]

  matchset live 0

  matchset live ball.mp4 --pick 346,151

  matchset live 0 --lan

Exit codes: 0 ended by Ctrl-C or SIGTERM (files are whole), 2 bad input or options.
"""


def live(options: LiveOptions) -> int:
    """See a camera or a video in the browser, click a ball, read where it is."""
    try:
        import starlette  # noqa: F401
        import uvicorn  # noqa: F401
        import websockets  # noqa: F401
    except ImportError as error:
        raise ValueError(f"the live page needs the extra web ({error.name} is missing): {advice('web')}") from None
    from matchset.live.serve import serve

    return serve(options)
