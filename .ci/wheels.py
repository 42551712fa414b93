"""Check that the wheel is whole and pure Python, and that all it needs has wheels for aarch64."""

import json
import shutil
import subprocess
import sys
import tempfile
import tomllib
import zipfile
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
GLIBC = 17, 24, 26, 27, 28  # Debian 11 has 2.31, so wheels for glibc 2.28 and older run there
OLDEST_PYTHON = "3.11"
PACKED = (".py", ".toml", ".html", ".css", ".js", ".svg")


def pip(*arguments: str) -> None:
    """Run pip; its words are shown only if it fails."""
    command = [sys.executable, "-m", "pip", *arguments, "--disable-pip-version-check"]
    run = subprocess.run(command, capture_output=True, text=True, stdin=subprocess.DEVNULL, check=False)
    if run.returncode:
        sys.exit(f"{run.stdout}{run.stderr}pip {arguments[0]} failed")


def built_wheel(folder: Path) -> Path:
    """Build the wheel in this folder, from a copy: setuptools leaves files behind and packs them again."""
    copy = folder / "copy"
    shutil.copytree(ROOT / "src", copy / "src", ignore=shutil.ignore_patterns("*.egg-info", "__pycache__"))
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, copy)
    pip("wheel", "--no-deps", "--wheel-dir", str(folder), str(copy))
    (wheel,) = folder.glob("*.whl")
    return wheel


def faults(wheel: Path) -> list[str]:
    """Say what is wrong with the wheel: its tag, or files that are not in it."""
    words = [] if wheel.name.endswith("-py3-none-any.whl") else [f"not a pure Python wheel: {wheel.name}"]
    packed = set(zipfile.ZipFile(wheel).namelist())
    files = [path for path in (ROOT / "src").rglob("*") if path.suffix in PACKED]
    source = {path.relative_to(ROOT / "src").as_posix() for path in files}
    return words + [f"missing from the wheel: {name}" for name in sorted(source - packed)]


def wheels_for_aarch64(requirements: list[str], folder: Path) -> list[str]:
    """Resolve the requirements for aarch64, wheels only; return the wheels' names, install nothing."""
    report = folder / "report.json"
    platforms = ["--platform", "manylinux2014_aarch64"]
    for version in GLIBC:
        platforms += ["--platform", f"manylinux_2_{version}_aarch64"]
    target = ["--python-version", OLDEST_PYTHON, "--implementation", "cp", "--only-binary=:all:"]
    place = ["--dry-run", "--ignore-installed", "--target", str(folder / "target"), "--report", str(report)]
    pip("install", "--quiet", *place, *target, *platforms, *requirements)
    resolved: dict[str, Any] = json.loads(report.read_text())
    return [item["download_info"]["url"].rsplit("/", 1)[-1] for item in resolved["install"]]


def main() -> None:
    """Run both checks and say what was found."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    with tempfile.TemporaryDirectory() as folder:
        wheel = built_wheel(Path(folder))
        if words := faults(wheel):
            sys.exit("\n".join(words))
        names = wheels_for_aarch64(project["dependencies"], Path(folder))
    foreign = [name for name in names if not name.endswith(("-any.whl", "aarch64.whl"))]
    if foreign:
        sys.exit(f"no wheel for aarch64: {', '.join(foreign)}")
    native = sum(name.endswith("aarch64.whl") for name in names)
    print(f"{wheel.name} is pure Python; on aarch64 it needs {len(names)} wheels, all there ({native} compiled)")


if __name__ == "__main__":
    main()
