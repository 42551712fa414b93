"""How the command line is called on this machine: `program`, so that what is printed can be typed."""

import os
import shutil
import sys
from pathlib import Path

NAME = "matchset"


def program() -> str:
    """Return the name of the command line as it must be typed in the folder of now.

    Returns
    -------
    str
        ``matchset`` where a shell finds it; else where it is, as in ``.venv/bin/matchset`` before the virtual
        environment is active.
    """
    called = Path(sys.argv[0])
    if called.name == "__main__.py":
        return f"{Path(sys.executable).name} -m {NAME}"
    if called.stem != NAME or shutil.which(NAME) is not None or not called.is_file():
        return NAME
    return min(os.path.relpath(called), str(called.absolute()), key=len)
