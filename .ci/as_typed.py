"""Type every command of the README, in its order, after a fresh clone: `make as-typed`.

What needs a device is left out, and said. A page that is served until Ctrl-C gets its Ctrl-C once it says its address.
"""

import os
import re
import signal
import subprocess
import sys
import tempfile

from first_picture import ROOT, fresh_environment

DEVICE = re.compile(r"matchset \w+ 0\b")  # a camera's number
TYPED = re.compile(r"^    (?:\$ )?((?:git|cd|make|\.|matchset|python|\.venv/bin/\w+) .*)$", re.MULTILINE)
SERVED = re.compile(r"matchset live\b")


def commands() -> list[str]:
    """Return the commands of the README, with this repository for the address."""
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    text = re.sub(r"^```.*?^```", "", text, flags=re.DOTALL | re.MULTILINE)
    lines = [line.split(" #")[0].strip() for line in TYPED.findall(text)]
    return [line.replace("ADDRESS", str(ROOT)) for line in lines]


def type_line(shell: "subprocess.Popen[str]", line: str) -> int:
    """Type a line into the shell; returns its exit code."""
    assert shell.stdin is not None
    assert shell.stdout is not None
    shell.stdin.write(f'{line}\necho "exit code $?"\n')
    shell.stdin.flush()
    for said in shell.stdout:
        if said.startswith("exit code "):
            return int(said.split()[-1])
        print("   ", said.rstrip(), flush=True)
        if SERVED.search(line) and "http://" in said:
            subprocess.run(["pkill", "-INT", "-P", str(shell.pid)], check=True)
    sys.exit(f"the shell has ended: {line}")


def main() -> None:
    """Type them all; it fails if one of them does."""
    failed = []
    with tempfile.TemporaryDirectory() as name:
        environment = fresh_environment() | {"XDG_CACHE_HOME": f"{name}/kept", "PYTHONUNBUFFERED": "1"}
        shell = subprocess.Popen(
            ["bash", "--norc"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            cwd=name,
            env=environment,
            start_new_session=True,
        )
        try:
            for line in commands():
                print("$", line, "(left out: it needs a camera)" * bool(DEVICE.search(line)), flush=True)
                code = 0 if DEVICE.search(line) else type_line(shell, line)
                if code not in ({0, 128 + signal.SIGINT} if SERVED.search(line) else {0}):
                    failed.append(f"{line}: exit code {code}")
        finally:
            os.killpg(shell.pid, signal.SIGKILL)
            shell.wait()
    if failed:
        sys.exit("\n".join(["these commands of the README fail as typed:", *failed]))


if __name__ == "__main__":
    main()
