"""Install the built files in new virtual environments and try them there: `make release-check`.

Python files of the repository are not on the path: all comes from the file that would be published.
"""

import os
import subprocess
import sys
import tarfile
import tempfile
import venv
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
# format: nothing of these is in an sdist
NOT_PACKED = "tests/", ".ci/", ".venv/", "benchmarks/", "training/", ".github/"
IN_SOURCE = "pyproject.toml", "README.md", "LICENSE", "CHANGELOG.md", "CITATION.cff", "src/matchset/sim/vehicle.toml"

PROGRAM = """
import importlib.metadata, pathlib, sys
import matchset as ms
assert pathlib.Path(ms.__file__).is_relative_to(sys.prefix), ms.__file__
clip = ms.sim.Clip(frames=5)
found = 0
for frame, truth in clip:
    if not frame.index:
        tracker = ms.Tracker(ms.Circle, ms.ColorModel.pick(frame.image, *clip.first_click), start=clip.first_click)
    found += bool(tracker.update(frame))
assert found == 5, found
if "gym" in sys.argv[1:]:
    import gymnasium
    env = gymnasium.make("matchset.flight.gym:matchset/Follow-v0", width_px=160, height_px=120, observation="pose")
    env.reset(seed=1)
    env.step(env.action_space.sample())
print("found in", found, "frames with matchset", importlib.metadata.version("matchset"))
"""


def run(*words: str | Path, folder: Path | None = None) -> str:
    """Run a command away from the repository; its words are shown if it fails."""
    environment = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "NUMBA_CACHE_DIR")}
    done = subprocess.run(
        [str(word) for word in words],
        capture_output=True,
        text=True,
        stdin=subprocess.DEVNULL,
        cwd=folder,
        env=environment,
        check=False,
    )
    if done.returncode:
        sys.exit(f"{done.stdout}{done.stderr}{' '.join(map(str, words))} failed")
    return done.stdout


def build(folder: Path) -> tuple[Path, Path]:
    """Build an sdist of what is committed, and the wheel from that; return both."""
    clone, target = folder / "clone", folder / "dist"
    run("git", "clone", "--quiet", ROOT, clone)
    target.mkdir()
    hook = "import sys; from setuptools import build_meta as b; b.build_sdist(sys.argv[1])"
    run(sys.executable, "-W", "ignore", "-c", hook, target, folder=clone)
    (source,) = target.glob("*.tar.gz")
    wheel_words = "wheel", "--quiet", "--no-deps", "--no-build-isolation", "--wheel-dir"
    run(sys.executable, "-m", "pip", *wheel_words, target, source)
    (wheel,) = target.glob("*.whl")
    return source, wheel


def faults(source: Path) -> list[str]:
    """Say what an sdist lacks, and what it should not have."""
    with tarfile.open(source) as packed:
        names = {name.partition("/")[2] for name in packed.getnames()}
    missing = [f"missing from the sdist: {name}" for name in IN_SOURCE if name not in names]
    return missing + [f"in the sdist: {name}" for name in sorted(names) if name.startswith(NOT_PACKED)]


def try_out(package: Path, extras: str, folder: Path) -> str:
    """Install a built file in a new virtual environment, and track a rendered clip and ask for help there."""
    home = folder / f"try-{package.suffix[1:]}"
    venv.create(home, with_pip=True)
    python = home / "bin" / "python"
    run(python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", f"{package}{extras}")
    run(home / "bin" / "matchset", "--help", folder=home)
    return run(python, "-c", PROGRAM, *(["gym"] if "gym" in extras else []), folder=home).strip()


def main() -> None:
    """Build, look inside, install, try."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        source, wheel = build(folder)
        if words := faults(source):
            sys.exit("\n".join(words))
        for package, extras in ((wheel, "[gym]"), (source, "")):
            print(f"{package.name}{extras}: {try_out(package, extras, folder)}")


if __name__ == "__main__":
    main()
