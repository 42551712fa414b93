"""The lock file of CI: hashes for everything, no index, within the open ranges of the package; and Numba's bound."""

import importlib.metadata
import re
import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parent.parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
LOCK = (ROOT / ".ci" / "requirements.lock").read_text(encoding="utf-8")
ENTRIES = LOCK.replace("\\\n", " ").splitlines()
LOCKED: dict[str, list[Requirement]] = {}
for line in ENTRIES:
    locked = Requirement(line.partition("--hash")[0])
    LOCKED.setdefault(canonicalize_name(locked.name), []).append(locked)
GROUPS = PROJECT["dependency-groups"]
OPEN = [*PROJECT["project"]["dependencies"], *PROJECT["build-system"]["requires"], *GROUPS["test"], *GROUPS["check"]]


def test_every_file_has_a_hash_and_no_index_is_named() -> None:
    assert len(ENTRIES) > 30
    for each in ENTRIES:
        assert re.search(r"==\S+ .*--hash=sha256:[0-9a-f]{64}", each), each[:80]
    assert not re.search(r"://|--(index|extra|find|trusted)|@", LOCK)


@pytest.mark.parametrize("wanted", OPEN)
def test_what_is_locked_lies_in_the_open_range(wanted: str) -> None:
    requirement = Requirement(wanted)
    found = LOCKED[canonicalize_name(requirement.name)]
    for each in found:
        (pin,) = each.specifier
        assert requirement.specifier.contains(pin.version), (wanted, str(each))


def test_numba_is_bound_below_its_next_minor_version() -> None:
    """Private parts of it are used: tests/numeric/test_private_hooks.py names each, and what breaks without it."""
    (bound,) = (each for each in map(Requirement, PROJECT["project"]["dependencies"]) if each.name == "numba")
    (pin,) = LOCKED["numba"][0].specifier
    major, minor = (int(part) for part in pin.version.split(".")[:2])
    assert not bound.specifier.contains(f"{major}.{minor + 1}.0")
    assert bound.specifier.contains(importlib.metadata.version("numba"))


def test_the_set_up_takes_the_lock_file() -> None:
    words = (ROOT / ".ci" / "setup").read_text(encoding="utf-8")
    assert "--require-hashes --requirement .ci/requirements.lock" in words
    assert "--no-deps --no-build-isolation --editable ." in words
