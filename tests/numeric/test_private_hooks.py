"""What `numeric.jit` takes of Numba that Numba does not promise: each test says what breaks where it is gone.

A new version of Numba that fails here: repair the hook, or leave it out, before the bound in pyproject.toml is raised.
What each saves: docs/decisions/141-what-the-private-hooks-of-numba-save.md.
"""

import importlib.util
import os
import pickle
import subprocess
import sys
import tomllib
from pathlib import Path
from types import ModuleType
from typing import Any

import numba
import numpy as np
import numpy.typing as npt
import pytest
from numba.core import serialize
from packaging.requirements import Requirement

from matchset.numeric import jit, kept_code
from matchset.numeric.code_identity import identity
from matchset.numeric.jit import helper, kernel
from matchset.numeric.kept_code import KeptCode

Floats = npt.NDArray[np.float64]

TRIED = tuple(f"0.{minor}" for minor in range(62, 69))
"""Versions of Numba with which all tests of this file have passed, one by one, the last on 2026-11-28."""

FAMILY = """
from numba import njit

GAIN = {gain}


@njit
def half_width(x):
    return GAIN * x


def typed(x):
    return x + 1
"""


@kernel(refcount=False)
def borrowed(rows: Floats) -> float:
    row = rows[0]
    for i in range(len(rows)):
        if rows[i, 0] > row[0]:
            row = rows[i]
    return float(row[0])


@kernel
def counted(rows: Floats) -> float:
    row = rows[0]
    for i in range(len(rows)):
        if rows[i, 0] > row[0]:
            row = rows[i]
    return float(row[0])


def closure(held: object) -> object:
    @kernel
    def outer(x: float) -> float:
        return float(held(x))  # type: ignore[operator]

    return outer


@kernel(refcount=False)
def summed(rows: Floats) -> float:
    total = 0.0
    for i in range(rows.shape[0]):
        total += max(rows[i, 0], rows[i, 1])
    return total


@kernel(refcount=False, reassociate=True)
def summed_in_any_order(rows: Floats) -> float:
    total = 0.0
    for i in range(rows.shape[0]):
        total += max(rows[i, 0], rows[i, 1])
    return total


def family(folder: Path, gain: float) -> ModuleType:
    """Import a user's file anew."""
    file = folder / "family_of_mine.py"
    file.write_text(FAMILY.format(gain=gain), encoding="utf-8")
    spec = importlib.util.spec_from_file_location("family_of_mine", file)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    kept_code._read_source.cache_clear()
    kept_code.source_stamp.cache_clear()
    return module


def test_this_numba_is_one_with_which_the_hooks_were_tried() -> None:
    """Otherwise nobody has looked whether what is replaced still does what it did."""
    assert numba.__version__.rpartition(".")[0] in TRIED, f"Numba {numba.__version__}: see the top of this file"


def test_no_numba_is_asked_for_with_which_they_were_not() -> None:
    project = tomllib.loads((Path(__file__).resolve().parents[2] / "pyproject.toml").read_text(encoding="utf-8"))
    asked = [Requirement(each) for each in project["project"]["dependencies"]]
    bounds = [each.specifier for each in asked if each.name == "numba"]
    assert bounds
    first, last = (int(version.rpartition(".")[2]) for version in (TRIED[0], TRIED[-1]))
    for bound in bounds:
        assert not bound.contains(f"0.{first - 1}.9")
        assert not bound.contains(f"0.{last + 1}.0")


def test_the_stamp_of_kept_code_is_ours() -> None:
    """Otherwise a kernel goes on with old code after a file that it imports has changed."""
    stamp = counted._cache.kept.stamp  # type: ignore[attr-defined]
    assert stamp == (numba.__version__, kept_code.source_stamp(Path(__file__)))


def test_code_of_an_older_source_is_never_found_under_the_key_of_a_new_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Otherwise a process that looks between the writing of index and code, or after a crash there, runs old code."""
    older, newer, other = (
        KeptCode(tmp_path, name, stamp, pickle.dumps) for name, stamp in (("f-3", 1), ("f-3", 2), ("f-30", 1))
    )
    for key in ("int", "float"):
        older.save(key, f"{key}, old")
        other.save(key, "of another")
    with monkeypatch.context() as patch:
        write = newer._write
        patch.setattr(newer, "_write", lambda path, content: path == newer.index and write(path, content))
        newer.save("int", "int, new")
    assert newer.load("int") is None
    newer.save("int", "int, new")
    newer.save("float", "float, new")
    assert [newer.load(key) for key in ("int", "float")] == ["int, new", "float, new"]
    assert [other.load(key) for key in ("int", "float")] == ["of another"] * 2


def test_two_processes_that_write_at_once_never_find_the_code_of_the_other(tmp_path: Path) -> None:
    """Otherwise, where both took the same name, a kernel runs code for other types."""
    one, other = (KeptCode(tmp_path, "f-3", 1, pickle.dumps) for _ in range(2))
    one.save("int", "code for int")
    data = (tmp_path / "f-3.1.nbc").read_bytes()
    one.flush()
    other.save("float", "code for float")
    (tmp_path / "f-3.1.nbc").write_bytes(data)
    assert other.load("float") is None


def test_kept_code_is_read_and_written_by_us() -> None:
    """Otherwise a file that a loss of power tore ends every command, and so does a full disk."""
    assert isinstance(counted._cache, jit._KernelCache)  # type: ignore[attr-defined]
    assert jit._CACHE.__abstractmethods__ == {
        *("cache_path", "load_overload", "save_overload", "enable", "disable", "flush")
    }
    for name in ("_reduce", "_rebuild"):
        assert hasattr(jit._RESULT, name)
    dump: Any = serialize.dumps
    assert pickle.loads(dump({1: 2})) == {1: 2}


def test_kept_code_is_filed_under_our_key() -> None:
    """Otherwise code of closures is compiled anew under a profiler, and finding it takes 50 ms of pickling."""
    njit: Any = numba.njit
    fresh = njit(counted.py_func)  # type: ignore[attr-defined]
    fresh(np.ones((2, 2)))
    (compiled,) = fresh.overloads.values()
    key = counted._cache.key(compiled.signature, compiled.codegen)  # type: ignore[attr-defined]
    assert key == (compiled.signature, compiled.codegen.magic_tuple(), identity(counted))


def test_the_key_of_a_closure_follows_what_it_holds(tmp_path: Path) -> None:
    """Otherwise a user's family that was changed in its own file goes on as it was."""
    sys.dont_write_bytecode, before = True, sys.dont_write_bytecode
    try:
        first, again, other = (family(tmp_path, gain) for gain in (2.0, 2.0, 3.0))
    finally:
        sys.dont_write_bytecode = before
    stamps = [identity(first.half_width), identity(again.half_width), identity(other.half_width)]
    assert stamps[0] == stamps[1] != stamps[2]
    assert identity(first.half_width) != identity(first.typed)


def test_two_closures_of_one_function_that_hold_the_same_are_the_same() -> None:
    assert identity(closure(counted)) == identity(closure(counted)) != identity(closure(borrowed))  # type: ignore[arg-type]


def test_identities_hold_in_another_process() -> None:
    """Otherwise nothing kept is found: hashes of strings and addresses differ from process to process."""
    program = (
        "from matchset.numeric.code_identity import identity; from matchset.shapes.circle import _trace; "
        "print(identity(_trace))"
    )
    seeds = ("1", "2")
    said = [
        subprocess.run(
            [sys.executable, "-c", program],
            env=os.environ | {"PYTHONHASHSEED": seed},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for seed in seeds
    ]
    assert said[0] == said[1]


def test_functions_that_were_typed_in_have_an_identity() -> None:
    """Two that differ by a name alone have the same instructions."""
    made: dict[str, object] = {}
    exec("import math\ndef f(x): return math.sin(x)\ndef g(x): return math.cos(x)", made)
    made["g"].__qualname__ = "f"  # type: ignore[attr-defined]
    made["g"].__name__ = "f"  # type: ignore[attr-defined]
    assert identity(made["f"]) != identity(made["g"])  # type: ignore[arg-type]


def test_scipy_waits_until_a_kernel_multiplies_matrices() -> None:
    """Otherwise a first answer with its kernels kept takes a seventh more; and matrices are multiplied all the same."""
    program = """
import sys, numpy as np
from matchset.numeric import jit, kept_code
import matchset.shapes.circle as circle
circle._half_width(np.ones(5))
print("scipy.linalg" in sys.modules, "numba.np.arraymath" in sys.modules)
import numba
print(numba.njit(lambda a: np.dot(a, a))(2.0 * np.eye(2)).tolist(), "scipy.linalg" in sys.modules)
"""
    said = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout.split(
        "\n"
    )
    assert said[0] == "False True"
    assert said[1] == "[[4.0, 0.0], [0.0, 4.0]] True"


@pytest.mark.parametrize(("function", "counts"), [(borrowed, False), (counted, True)])
def test_references_are_counted_only_where_it_is_wanted(function: Any, counts: bool) -> None:
    """Otherwise each view costs an atomic instruction, 1 us of an update, and a first answer takes a fifth longer."""
    assert function.targetoptions.get("_nrt", True) == counts
    njit: Any = numba.njit
    fresh = njit(function.py_func, _nrt=counts)  # Numba does not show code that was kept
    assert fresh(np.ones((2, 2))) == 1.0
    assert all(("NRT_" in text) == counts for text in fresh.inspect_llvm().values())


def test_kernels_without_arrays_of_their_own_run_few_passes() -> None:
    """Otherwise a first answer takes a tenth longer: rewriting of what they do not contain, again and again."""
    njit: Any = numba.njit
    fresh = njit(_nrt=False, pipeline_class=jit._KernelCompiler)(borrowed.py_func)  # type: ignore[attr-defined]
    assert fresh(np.ones((2, 2))) == 1.0
    (compiled,) = fresh.overloads.values()
    assert [*compiled.metadata["pipeline_times"]] == ["kernel"]
    assert len(compiled.metadata["pipeline_times"]["kernel"]) == len(jit.PASSES)
    assert isinstance(compiled.library, jit._KernelLibrary)
    assert borrowed._compiler.pipeline_class is jit._KernelCompiler  # type: ignore[attr-defined]


def test_types_are_looked_up_once_for_the_same_flags(monkeypatch: pytest.MonkeyPatch) -> None:
    """Otherwise every `a + b` is looked up several times, a fifth of a first answer; only while a kernel compiles."""
    looked_up, before = [], jit._FUNCTION.get_call_type

    def count(*call: Any) -> Any:
        looked_up.append((*call[:1], *call[2:3], jit._flags()))
        return jit_find(*call)

    jit_find = jit._find_call_type
    monkeypatch.setattr(jit, "_find_call_type", count)
    monkeypatch.setattr(jit, "_FOUND", {})
    rows = np.array(((1.0, 2.0), (4.0, 3.0)))
    for function in (summed, summed_in_any_order):
        assert function(rows) == 6.0  # compiled, or taken from what was kept
        function.recompile()  # type: ignore[attr-defined]
        assert function(rows) == 6.0
    assert len(looked_up) == len(set(looked_up)) > 0
    assert len({flags for *_, flags in looked_up}) >= 2
    assert jit._FUNCTION.get_call_type is before


@helper
def doubled(x: float) -> float:
    return 2.0 * x


@kernel
def quadrupled(x: float) -> float:
    return doubled(doubled(x))


def test_what_only_kernels_call_has_no_machine_code_of_its_own() -> None:
    """Otherwise a first answer with nothing kept takes half as long again."""
    assert quadrupled(3.0) == 12.0  # compiled, or taken from what was kept
    quadrupled.recompile()  # type: ignore[attr-defined]
    assert quadrupled(3.0) == 12.0
    (compiled,) = doubled.overloads.values()  # type: ignore[attr-defined]
    assert isinstance(compiled.library, jit._PieceLibrary)
    assert compiled.library.get_pointer_to_function(compiled.fndesc.llvm_func_name) == 0
