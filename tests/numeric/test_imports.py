import tomllib
from pathlib import Path

import pytest

from matchset.numeric.imports import EXTRAS, advice

ROOT = Path(__file__).parent.parent.parent
DECLARED = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["optional-dependencies"]


@pytest.mark.parametrize("extra", EXTRAS)
def test_what_is_advised_is_what_the_extra_declares(extra: str) -> None:
    assert EXTRAS[extra].split() == DECLARED[extra]
    assert advice(extra) == "pip install " + " ".join(f"'{package}'" for package in DECLARED[extra])


def test_no_package_is_declared_twice_under_different_bounds() -> None:
    bounds: dict[str, set[str]] = {}
    for packages in DECLARED.values():
        for package in packages:
            bounds.setdefault(package.split(">")[0].split("[")[0], set()).add(package)
    assert all(len(each) == 1 for each in bounds.values()), bounds
    alone = [packages[0] for packages in DECLARED.values() if len(packages) == 1]
    assert len(alone) == len(set(alone)), "two extras of one package"


def test_no_advice_names_an_index_that_does_not_have_this_package() -> None:
    for path in [*(ROOT / "src").rglob("*.py"), *(ROOT / "docs").glob("*.md"), ROOT / "README.md"]:
        text = path.read_text(encoding="utf-8")
        assert "pip install 'matchset" not in text, path
        assert 'pip install "matchset' not in text, path
