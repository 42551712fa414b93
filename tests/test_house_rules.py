"""The rules for folders, functions and numbers, read from the source."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "src" / "matchset"
FILES = sorted(path.relative_to(PACKAGE).as_posix() for path in PACKAGE.rglob("*.py"))
FOLDERS = sorted(
    folder.relative_to(ROOT).as_posix()
    for top in (PACKAGE, ROOT / "benchmarks", ROOT / "training")
    for folder in [top, *top.rglob("*")]
    if folder.is_dir() and any(folder.glob("*.py"))
)

MOST_MODULES = 12  # in a folder, beside its `__init__`
MOST_LINES = 40  # of a function, without its signature and its docstring
MOST_PARAMETERS = 6  # of a function, `self` not counted
MOST_EXCEPTIONS = 10  # functions with more parameters, each of which says why in its docstring
SAYS_WHY = re.compile(r"\b(seven|eight|nine|ten|eleven|twelve|thirteen) parameters\b", re.IGNORECASE)
REASONS = ("geometry:", "format:", "theorem:")

Function = ast.FunctionDef | ast.AsyncFunctionDef


def functions(name: str) -> Iterator[Function]:
    """Every function and method of a file, those inside others included."""
    for node in ast.walk(ast.parse((PACKAGE / name).read_text(encoding="utf-8"), name)):
        if isinstance(node, Function):
            yield node


def lines_of(function: Function) -> int:
    """Lines of a function's body without its docstring, and without the functions that it defines."""
    body = function.body
    documented = isinstance(body[0], ast.Expr) and isinstance(body[0].value, ast.Constant)
    if documented and isinstance(body[0].value.value, str):  # type: ignore[attr-defined]
        body = body[1:]
    if not body:
        return 0
    total = (body[-1].end_lineno or 0) - body[0].lineno + 1
    inner = [node for node in ast.walk(function) if isinstance(node, Function) and node is not function]
    return total - sum((node.end_lineno or 0) - node.lineno + 1 for node in inner)


def parameters_of(function: Function) -> int:
    """How many parameters a function takes, `self` and `cls` not counted."""
    args = function.args
    every = [*args.posonlyargs, *args.args, *args.kwonlyargs]
    return len([arg for arg in every if arg.arg not in ("self", "cls")])


def crowded_functions() -> dict[str, str]:
    """Functions with more parameters than the rule, and their docstrings."""
    return {
        f"{name}:{function.name}": ast.get_docstring(function) or ""
        for name in FILES
        for function in functions(name)
        if parameters_of(function) > MOST_PARAMETERS and not _is_overload(function)
    }


def _is_overload(function: Function) -> bool:
    return any(isinstance(each, ast.Name) and each.id == "overload" for each in function.decorator_list)


def numbers_of(node: ast.expr) -> bool:
    """Whether a value holds a number that is not handed to a class or function."""
    if isinstance(node, ast.Call | ast.Lambda | ast.Subscript | ast.JoinedStr):
        return isinstance(node, ast.Call) and _is_plain_number_call(node)
    if isinstance(node, ast.Constant):
        return isinstance(node.value, int | float | complex) and not isinstance(node.value, bool)
    return any(numbers_of(child) for child in ast.iter_child_nodes(node) if isinstance(child, ast.expr))


def _is_plain_number_call(node: ast.Call) -> bool:
    """Whether a call only makes a number or an array of numbers: np.float32(0.4), np.array(...), math.radians(5)."""
    function = node.func
    owner = function.value.id if isinstance(function, ast.Attribute) and isinstance(function.value, ast.Name) else ""
    return owner in ("np", "math") and any(numbers_of(argument) for argument in node.args)


def unexplained_numbers(text: str) -> list[str]:
    """Module-level numbers that neither are TINY nor say which kind of fact they are."""
    lines = text.splitlines()
    found = []
    for node in ast.parse(text).body:
        if isinstance(node, ast.Assign):
            targets, value = node.targets, node.value
        elif isinstance(node, ast.AnnAssign) and node.value is not None:
            targets, value = [node.target], node.value
        else:
            continue
        names = [each.id for target in targets for each in ast.walk(target) if isinstance(each, ast.Name)]
        if names == ["TINY"] or not numbers_of(value):
            continue
        first, last = node.lineno - 1, node.end_lineno or node.lineno
        above = first - 1
        comment = " ".join(line.partition("#")[2] for line in lines[first:last])
        while above >= 0 and lines[above].startswith("#"):
            comment, above = lines[above] + comment, above - 1
        if not any(reason in comment for reason in REASONS):
            found.append(f"{node.lineno}: {', '.join(names)}")
    return found


@pytest.mark.parametrize("folder", FOLDERS)
def test_a_folder_has_one_role_and_few_modules(folder: str) -> None:
    modules = [path for path in (ROOT / folder).glob("*.py") if path.name not in ("__init__.py", "__main__.py")]
    assert len(modules) <= MOST_MODULES, f"{folder} has {len(modules)} modules"


@pytest.mark.parametrize("folder", [folder for folder in FOLDERS if folder != "src/matchset"])
def test_a_folder_says_what_is_inside_and_in_which_order_to_read(folder: str) -> None:
    docstring = ast.get_docstring(ast.parse((ROOT / folder / "__init__.py").read_text(encoding="utf-8"))) or ""
    assert len(docstring.splitlines()) >= 3, f"{folder}/__init__.py: {docstring!r}"


@pytest.mark.parametrize("name", FILES)
def test_functions_are_short(name: str) -> None:
    long = {function.name: lines_of(function) for function in functions(name) if lines_of(function) > MOST_LINES}
    assert not long, f"{name}: {long}"


def test_functions_have_few_parameters_or_say_why() -> None:
    crowded = crowded_functions()
    silent = [place for place, docstring in crowded.items() if not SAYS_WHY.search(docstring)]
    assert not silent
    assert len(crowded) <= MOST_EXCEPTIONS, sorted(crowded)


@pytest.mark.parametrize("name", FILES)
def test_a_number_at_module_level_is_a_fact_and_all_else_is_a_parameter(name: str) -> None:
    assert not unexplained_numbers((PACKAGE / name).read_text(encoding="utf-8"))


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("LIMIT = 0.4  # px: gate", ["1: LIMIT"]),
        ("A, B = 1, np.float32(2.0)", ["1: A, B"]),
        ("TINY = 1e-9", []),
        ("BITS = 5  # format: bits of a channel in the color table", []),
        ("# theorem: 1/Phi^-1(3/4), Hampel 1974\nMAD = 1.4826", []),
        ("DEFAULT = FitParameters(gate=3.0)", []),
        ("NAMES = ('a', 'b')", []),
        ("GRAVITY: float = 9.81", ["1: GRAVITY"]),
    ],
)
def test_the_rule_for_numbers(text: str, found: list[str]) -> None:
    assert unexplained_numbers(text) == found
