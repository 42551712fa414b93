"""Where and with what the figures were measured: `Machine`."""

import datetime
import importlib.metadata
import os
import platform
import shlex
import subprocess
import sys
from pathlib import Path

import msgspec

LIBRARIES = (
    "matchset",
    "numpy",
    "scipy",
    "numba",
    "opencv-python-headless",
    "opencv-contrib-python-headless",
    "scikit-image",
    "pupil-apriltags",
)
ROOT = Path(__file__).resolve().parents[1]


class Machine(msgspec.Struct, frozen=True):
    """Where and with what the figures were measured.

    Parameters
    ----------
    date : str
        Day and minute, UTC.
    commit : str
        Short hash, "+" behind it if files differ from it; "none" without one.
    processor, system, python : str
    cores : int
    libraries : dict of str to str
        Versions.
    command : str
        How the run was started.
    """

    date: str
    commit: str
    processor: str
    cores: int
    system: str
    python: str
    libraries: dict[str, str]
    command: str

    @classmethod
    def here(cls) -> "Machine":
        """Describe this machine."""
        return cls(
            date=datetime.datetime.now(datetime.UTC).strftime("%Y-%m-%d %H:%M UTC"),
            commit=_commit(),
            processor=_processor(),
            cores=os.cpu_count() or 1,
            system=f"{platform.system()} {platform.release()}",
            python=platform.python_version(),
            libraries=_versions(),
            command=shlex.join(["python", "-m", "benchmarks", *sys.argv[1:]]),
        )

    def words(self) -> str:
        """Write it as a sentence or two."""
        libraries = ", ".join(f"{name} {version}" for name, version in self.libraries.items())
        return (
            f"{self.date}, commit {self.commit}. {self.processor}, {self.cores} cores, {self.system}; "
            f"Python {self.python}, {libraries}."
        )


def _versions() -> dict[str, str]:
    """Versions of the libraries that are here."""
    versions = {}
    for name in LIBRARIES:
        try:
            versions[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            continue
    return versions


def _commit() -> str:
    head = _git("rev-parse", "--short", "HEAD")
    if not head:
        return "none"
    # The results themselves change with every run.
    pages = ("benchmarks/RESULTS.md", "benchmarks/REAL.md", "benchmarks/FLIGHT.md")
    results = (*pages, "benchmarks/regression/kept.toml", "benchmarks/pictures")
    changed = _git("status", "--porcelain", "--", ".", *(f":!{path}" for path in (*results, "docs", "README.md")))
    return head + ("+" if changed else "")


def _git(*words: str) -> str:
    try:
        done = subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return ""
    return done.stdout.strip()


def _processor() -> str:
    cpuinfo = Path("/proc/cpuinfo")
    if cpuinfo.exists():
        for line in cpuinfo.read_text(encoding="utf-8").splitlines():
            name, _, value = line.partition(":")
            if name.strip() in ("model name", "Model"):
                return value.strip()
    return platform.processor() or platform.machine()
