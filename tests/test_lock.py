"""The lock files of CI: hashes for everything, no index, within the open ranges of the package; and Numba's bound."""

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
    if requirement.marker is not None and not requirement.marker.evaluate():
        pytest.skip(f"for other systems: {wanted}")
    found = [each for each in LOCKED[canonicalize_name(requirement.name)] if _is_for_here(each)]
    assert found
    for each in found:
        (pin,) = each.specifier
        assert requirement.specifier.contains(pin.version), (wanted, str(each))


def _is_for_here(requirement: Requirement) -> bool:
    return requirement.marker is None or requirement.marker.evaluate()


def test_numba_is_bound_below_its_next_minor_version() -> None:
    """Private parts of it are used: tests/numeric/test_private_hooks.py names each, and what breaks without it."""
    numbas = [each for each in map(Requirement, PROJECT["project"]["dependencies"]) if each.name == "numba"]
    (bound,) = (each for each in numbas if _is_for_here(each))
    (pin,) = next(each for each in LOCKED["numba"] if _is_for_here(each)).specifier
    major, minor = (int(part) for part in pin.version.split(".")[:2])
    assert not bound.specifier.contains(f"{major}.{minor + 1}.0")
    assert bound.specifier.contains(importlib.metadata.version("numba"))


@pytest.mark.parametrize(("script", "lock"), [("setup", "package"), ("tools", "requirements")])
def test_the_set_up_takes_the_lock_files(script: str, lock: str) -> None:
    words = (ROOT / ".ci" / script).read_text(encoding="utf-8")
    assert f"--require-hashes --requirement .ci/{lock}.lock" in words
    assert script != "setup" or "--no-deps --no-build-isolation --editable ." in words


def test_the_first_picture_needs_a_part_of_the_lock_file_and_all_that_the_package_depends_on() -> None:
    part = (ROOT / ".ci" / "package.lock").read_text(encoding="utf-8").replace("\\\n", " ").splitlines()
    assert {" ".join(line.split()) for line in part} < {" ".join(line.split()) for line in ENTRIES}
    names = {canonicalize_name(Requirement(line.partition("--hash")[0]).name) for line in part}
    needed = [*PROJECT["project"]["dependencies"], *PROJECT["build-system"]["requires"]]
    assert {canonicalize_name(Requirement(each).name) for each in needed} <= names
