"""What is not needed is not loaded: neither by `import matchset` nor by the command line's help."""

import ast
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

import matchset

HEAVY = ("numba", "cv2", "scipy", "matplotlib", "PIL", "numpy")
HELP = "import sys\nfrom matchset.cli import main\nsys.argv[1:] = {arguments}\ntry: main()\nexcept SystemExit: pass"


def loaded(program: str) -> list[str]:
    """Heavy packages that a fresh process has loaded after a program."""
    asked = f"{program}\nimport sys\nprint(*[name for name in {HEAVY!r} if name in sys.modules], file=sys.stderr)"
    done = subprocess.run([sys.executable, "-c", asked], capture_output=True, text=True, check=True)
    return done.stderr.split()


@pytest.mark.parametrize(
    "program",
    [
        "import matchset",
        "import matchset; dir(matchset)",
        "from matchset import cli",
        "import matchset; dir(matchset.sim)",
    ],
)
def test_an_import_loads_nothing_heavy(program: str) -> None:
    assert loaded(program) == []


@pytest.mark.parametrize("arguments", [["--help"], ["track", "--help"], ["--version"]])
def test_help_loads_nothing_heavy(arguments: list[str]) -> None:
    assert loaded(HELP.format(arguments=arguments)) == []


def test_first_pictures_need_no_drawing_library() -> None:
    assert not set(loaded("import matchset; matchset.Tracker, matchset.ColorModel")) & {"matplotlib", "PIL"}


def test_every_public_name_is_there_and_listed() -> None:
    offered = {name for name in dir(matchset) if not name.startswith("__")}
    assert offered == {*matchset.__all__, *matchset._FOLDERS}
    for name in matchset.__all__:
        assert getattr(matchset, name).__name__ == name


def test_a_name_that_is_not_there_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="no attribute 'Trakcer'"):
        matchset.Trakcer  # type: ignore[attr-defined]  # noqa: B018


def test_public_folders_have_public_names() -> None:
    """`ms.sim.World` needs no other import, and knows all that its page explains."""
    done = subprocess.run(
        [sys.executable, "-c", "import matchset as ms; print(ms.sim.World.__name__, *dir(ms.sim))"],
        capture_output=True,
        text=True,
        check=True,
    )
    assert {"World", "Clip", "WorldCameras", "Scene", "DigitalCamera"} <= set(done.stdout.split())
    for folder in matchset._FOLDERS:
        assert folder in dir(matchset)
        module = getattr(matchset, folder)
        assert {name for name in dir(module) if not name.startswith("__")} == set(module.__all__)
        for name in module.__all__:
            assert (getattr(module, name).__doc__ or "").strip(), f"{folder}.{name} says nothing about itself"
        with pytest.raises(AttributeError, match="no attribute 'Wrold'"):
            module.Wrold  # noqa: B018


@pytest.mark.parametrize("module", [matchset, *(getattr(matchset, name) for name in matchset._FOLDERS)])
def test_the_table_of_names_is_what_type_checkers_read(module: ModuleType) -> None:
    tree = ast.parse(Path(str(module.__file__)).read_text(encoding="utf-8"))
    block = next(node for node in tree.body if isinstance(node, ast.If))
    read = {
        alias.name: node.module
        for node in block.body
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("matchset.")
        for alias in node.names
        if alias.name not in matchset._FOLDERS
    }
    assert read == module._MODULES
    assert sorted(read) == sorted(module.__all__)
