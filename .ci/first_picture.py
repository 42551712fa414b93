"""Type what the README says from `git clone` to the first picture, in an empty folder: `make first-picture`.

It fails without a picture, and if it took more than 45 s of computing (all processes together, user and system).
"""

import os
import re
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
MOST_SECONDS = 45.0  # format: of computing, what the README promises


def commands() -> list[str]:
    """Return the commands of the README, with this repository for the address."""
    text = (ROOT / "README.md").read_text(encoding="utf-8").split("## Install")[1]
    block = re.search(r"(?:^    .*\n)+", text, re.MULTILINE)
    lines = [] if block is None else [line.split("#")[0].strip() for line in block[0].splitlines()]
    return [line.replace("ADDRESS", str(ROOT)) for line in lines]


def fresh_environment() -> dict[str, str]:
    """Return this environment without what `make`, a virtual environment and the caller set."""
    left_out = {"PYTHONPATH", "NUMBA_CACHE_DIR", "VIRTUAL_ENV"}
    return {name: value for name, value in os.environ.items() if name not in left_out and not name.startswith("MAKE")}


def main() -> None:
    """Type them, and say what they took."""
    environment = fresh_environment()
    with tempfile.TemporaryDirectory() as name, tempfile.TemporaryDirectory() as kept:
        environment["XDG_CACHE_HOME"] = kept  # as on a machine that has never compiled a kernel
        typed = commands()
        print("\n".join(typed), flush=True)
        subprocess.run(["sh", "-ec", "\n".join(typed)], cwd=name, env=environment, check=True)
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        pictures = list(Path(name).glob("matchset/runs/*/sheet.png"))
    seconds = used.ru_utime + used.ru_stime
    print(f"{len(typed)} commands, {seconds:.0f} s of computing, pictures: {len(pictures)}", flush=True)
    if not pictures or seconds > MOST_SECONDS:
        sys.exit(f"the README promises a picture after {MOST_SECONDS:g} s")


if __name__ == "__main__":
    main()
