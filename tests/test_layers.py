"""The rules of the house, read from the source: who may import whom, and who may touch the world outside."""

import ast
import functools
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

PACKAGE = Path(__file__).resolve().parents[1] / "src" / "matchset"
LAYERS = [
    "numeric",
    "shapes",
    "image",
    "media",
    "fitting",
    "tracking",
    "camera",
    "localization",
    "control",
    "sim",
    "links",
    "app",
    "flight",
    "live",
    "batch",
]
PEOPLE = {"app", "flight", "live", "batch", "cli"}
"""Floors that print and draw, and read files and clocks."""
FILES = sorted(path.relative_to(PACKAGE).as_posix() for path in PACKAGE.rglob("*.py"))

OUTSIDE = {"datetime", "glob", "io", "os", "pathlib", "shutil", "socket", "subprocess", "tempfile", "time"}
MAY_TOUCH_OUTSIDE = {
    "media/capture.py",  # OpenCV's log level is set in the environment
    "image/color.py",
    "image/disc_network/network.py",  # reads the weights of the package
    "image/files/color_file.py",
    "media/camera_stream.py",
    "media/streams/answer.py",  # asks an address that gave no pictures
    "image/files/reading.py",
    "image/files/whole_file.py",
    "media/video_files/image_folder.py",
    "media/video_files/container.py",
    "media/video_files/stream_choice.py",
    "media/video_files/pyav_capture.py",
    "media/video_files/video_file.py",
    "media/video.py",
    "media/opening.py",  # which kind of source a name means
    "image/frame.py",  # the clock, for arrays that come without times
    "media/bags/bag.py",
    "media/bags/mcap_images.py",
    "media/bags/rosbag_file.py",
    "camera/calibrate.py",
    "camera/camera_toml.py",
    "camera/camera_model.py",
    "numeric/jit.py",  # the compiled code's key holds a checksum of the sources: decision 012
    "numeric/code_identity.py",  # reads where the source of a function stands: decision 012
    "numeric/kept_code.py",  # machine code, kept under a checksum of its sources: decision 012
}
READS_OR_WRITES = {"fromfile", "imread", "imwrite", "load", "loadtxt", "open", "save", "savez", "tofile"}
FOR_PEOPLE = {"matplotlib", "PIL", "rich", "typer"}
SHOWS = {"print", "putText", "arrowedLine", "drawMarker"}
MAY_PLOT = {
    "app/course/figure.py",
    "app/drawing/curves.py",
    "app/drawing/plot_style.py",
    "flight/report/plots.py",
    "app/locate/path_picture.py",
    "flight/simulate/picture.py",
}
LONGEST = 400  # lines


@functools.cache
def tree(name: str) -> ast.Module:
    return ast.parse((PACKAGE / name).read_text(encoding="utf-8"), name)


def imported(name: str) -> Iterator[str]:
    """Full names of what a file imports, modules and names in them, wherever in it the import stands."""
    for node in ast.walk(tree(name)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{name}:{node.lineno}: relative import"
            module = node.module or ""
            if module != "matchset":  # from matchset import shapes
                yield module
            yield from (f"{module}.{alias.name}" for alias in node.names)


def called(name: str) -> Iterator[str]:
    """Names of the functions and methods a file calls, without what stands before the dot."""
    for node in ast.walk(tree(name)):
        if isinstance(node, ast.Call):
            if isinstance(node.func, ast.Name):
                yield node.func.id
            elif isinstance(node.func, ast.Attribute):
                yield node.func.attr


def layer(name: str) -> str:
    """Layer of a file; of `reference.py`, which stands beside them, its own name."""
    return name.split("/")[0].removesuffix(".py")


def allowed(name: str) -> set[str]:
    """Layers a file may import from."""
    if name in ("__init__.py", "__main__.py", "cli.py"):
        return {*LAYERS, "cli", "reference"}
    if layer(name) == "reference":
        return {"shapes"}
    return set(LAYERS[: LAYERS.index(layer(name)) + 1])


def test_there_are_only_the_layers_of_the_design() -> None:
    assert {layer(name) for name in FILES} <= {*LAYERS, "reference", "__init__", "__main__", "cli"}


def violations(rule: Callable[[str], Any]) -> dict[str, Any]:
    """Files that break a rule, and how: the rule returns what is wrong with a file, empty where nothing is."""
    return {name: wrong for name in FILES if (wrong := rule(name))}


def roots(name: str) -> set[str]:
    """Packages that a file imports."""
    return {module.split(".")[0] for module in imported(name)}


def test_a_layer_imports_only_from_those_above_it() -> None:
    def foreign(name: str) -> set[str]:
        parts = [module.split(".") for module in imported(name) if module.split(".")[0] == "matchset"]
        return {".".join(path) for path in parts if len(path) < 2 or path[1] not in allowed(name)}

    assert not violations(foreign)


def test_no_file_imports_itself_by_way_of_others() -> None:
    """Also not inside a function, or for types alone: what needs each other stands in one file."""
    modules = {"matchset." + name.removesuffix(".py").replace("/", "."): name for name in FILES}
    modules |= {module.removesuffix(".__init__"): name for module, name in modules.items()}
    files = {name for name in FILES if not name.endswith("__init__.py")}  # which name what is public
    waiting = {name: {modules[each] for each in imported(name) if each in modules} & files for name in files}
    while free := [name for name, others in waiting.items() if not others & waiting.keys() - {name}]:
        for name in free:
            del waiting[name]
    assert not waiting


def test_no_public_class_has_the_name_of_another_one() -> None:
    """Who reads a name in a traceback knows where it stands."""
    where: dict[str, list[str]] = {}
    for name in FILES:
        for node in tree(name).body:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                where.setdefault(node.name, []).append(name)
    assert not {name: files for name, files in where.items() if len(files) > 1}


def test_only_the_jit_policy_imports_numba() -> None:
    assert not violations(lambda name: name != "numeric/jit.py" and roots(name) & {"numba", "llvmlite"})


def test_files_and_clocks_are_touched_only_where_the_design_says() -> None:
    def touched(name: str) -> set[str]:
        if layer(name) in {"links", *PEOPLE} or name in MAY_TOUCH_OUTSIDE:
            return set()
        return roots(name) & OUTSIDE | set(called(name)) & READS_OR_WRITES

    assert not violations(touched)


def test_only_the_app_prints_and_draws() -> None:
    def shown(name: str) -> set[str]:
        return set() if layer(name) in PEOPLE else roots(name) & FOR_PEOPLE | set(called(name)) & SHOWS

    assert not violations(shown)


@pytest.mark.parametrize(
    ("package", "files"),
    [
        ("serial", {"links/serial_port.py"}),
        ("mcap", {"flight/recording/mcap_file.py", "media/bags/mcap_images.py", "media/bags/mcap_records.py"}),
        ("supervision", {"app/adapters/supervision_detections.py"}),
        ("rosbags", {"media/bags/rosbag_file.py"}),
        (
            "av",
            {
                "app/films/pyav_encoder.py",
                "sim/digital_camera/h264.py",
                "media/video_files/pyav_capture.py",
                "media/bags/video_messages.py",
            },
        ),
    ],
)
def test_an_extra_is_imported_by_a_file_of_its_own_and_only_when_it_is_needed(package: str, files: set[str]) -> None:
    users = {name for name in FILES if package in {module.split(".")[0] for module in imported(name)}}
    assert users == files
    above = [module for file in files for node in tree(file).body for module in _of(node)]
    assert package not in {module.split(".")[0] for module in above}


def test_gymnasium_is_imported_by_its_folder_alone() -> None:
    """A class of an environment is one of Gymnasium's, so the files import it; nothing else loads these files."""
    gym = {name for name in FILES if name.startswith("flight/gym/")}
    assert {name for name in FILES if "gymnasium" in roots(name)} <= gym
    assert not violations(
        lambda name: name not in gym and any(m.startswith("matchset.flight.gym.") for m in imported(name))
    )


def _of(statement: ast.stmt) -> list[str]:
    """Modules that a statement imports when its file is loaded."""
    if isinstance(statement, ast.Import):
        return [alias.name for alias in statement.names]
    return [statement.module or ""] if isinstance(statement, ast.ImportFrom) else []


def test_only_reports_load_matplotlib() -> None:
    assert not violations(lambda name: name not in MAY_PLOT and "matplotlib" in roots(name))


def test_nothing_opens_a_window() -> None:
    assert not violations(lambda name: set(called(name)) & {"imshow", "namedWindow", "waitKey", "selectROI"})


def test_files_are_short() -> None:
    def too_long(name: str) -> int:
        lines = (PACKAGE / name).read_text(encoding="utf-8").count("\n")
        return lines if lines > LONGEST else 0

    assert not violations(too_long)
