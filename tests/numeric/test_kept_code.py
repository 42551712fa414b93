"""Kept machine code that was torn, zeroed, exchanged or cannot be written: kernels answer right all the same."""

import errno
import importlib.util
import logging
import os
import pickle
import random
import shutil
import stat
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from matchset.numeric import kept_code
from matchset.numeric.kept_code import CHECKSUM, MAGIC, PACKAGE, KeptCode, kept_folder, make_kept_folder

PROGRAM = """
import numpy as np
from matchset.numeric.rotation import rotate, rotation_vector_between
from matchset.shapes.circle import Circle
from matchset.shapes.family_check import check_contract
matrix, vector = np.eye(3), np.empty(3)
rotate(matrix, np.array((0.1, 0.2, 0.3)))
rotation_vector_between(np.eye(3), matrix, vector)
check_contract(Circle)
print(vector.round(9).tolist(), sum(rotate.stats.cache_hits.values()))
"""
SAME = "[0.1, 0.2, 0.3]"


def run(folder: Path, program: str = PROGRAM, **environment: str) -> tuple[str, str]:
    """What a fresh process with its kept code in a folder says on stdout and on stderr."""
    there = os.environ | {"NUMBA_CACHE_DIR": str(folder)} | environment
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, env=there, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip(), done.stderr.strip()


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with code of a few kernels."""
    folder = tmp_path_factory.mktemp("kept")
    assert run(folder) == (f"{SAME} 0", "")
    return folder


def test_a_program_goes_on_with_torn_code_says_it_once_and_heals_it(kept: Path, tmp_path: Path) -> None:
    """What users saw was "Circle is no family of shapes", from a kernel that was loaded while a family is checked."""
    folder = tmp_path / "kept"
    shutil.copytree(kept, folder)
    indices = sorted(folder.rglob("*.nbi"))
    assert len(indices) >= 4
    for index in indices[::2]:
        index.write_bytes(index.read_bytes()[: index.stat().st_size // 2])
    for index in indices[1::2]:
        for file in index.parent.glob(f"{index.stem}.*.nbc"):
            file.write_bytes(file.read_bytes()[:-100] + bytes(100))
    answer, words = run(folder)
    assert answer.startswith(SAME)
    assert words.count("\n") == 0
    assert words.startswith("kept machine code is damaged and compiled anew: "), words
    assert run(folder) == (f"{SAME} 1", "")


DAMAGES: dict[str, Callable[[bytes], bytes]] = {
    "empty": lambda _: b"",
    "cut in the beginning": lambda data: data[: len(MAGIC) // 2],
    "cut in the middle": lambda data: data[: len(data) // 2],
    "last byte lost": lambda data: data[:-1],
    "zeros": lambda data: bytes(len(data)),
    "zeros in the second half": lambda data: data[: len(data) // 2] + bytes(len(data) - len(data) // 2),
    "a page of zeros": lambda data: data[:40] + bytes(len(data[40:4136])) + data[4136:],
    "a flipped bit": lambda data: data[: len(data) - 40] + bytes((data[-40] ^ 8,)) + data[len(data) - 39 :],
    "longer": lambda data: data + b"\0" * 512,
    "text": lambda _: b"not code at all\n" * 20,
}


@pytest.fixture
def nothing_said(monkeypatch: pytest.MonkeyPatch) -> None:
    """As in a fresh process."""
    monkeypatch.setattr(kept_code, "_SAID", set())


def said(caplog: pytest.LogCaptureFixture) -> str:
    """The one line that was said."""
    assert len(caplog.records) == 1, caplog.text
    return caplog.records[0].getMessage()


@pytest.mark.usefixtures("nothing_said")
@pytest.mark.parametrize("ending", ["nbi", "1.nbc"])
@pytest.mark.parametrize("how", DAMAGES)
def test_torn_files_are_removed_said_once_and_healed(
    tmp_path: Path, caplog: pytest.LogCaptureFixture, how: str, ending: str
) -> None:
    keepers = [KeptCode(tmp_path, name, "stamp", pickle.dumps) for name in ("f-1", "g-2")]
    for keeper in keepers:
        keeper.save("key", bytes(range(256)) * 20)
        file = tmp_path / f"{keeper.name}.{ending}"
        file.write_bytes(DAMAGES[how](file.read_bytes()))
        assert keeper.load("key") is None
        assert not file.exists()
        keeper.save("key", "anew")
        assert keeper.load("key") == "anew"
    assert [record.getMessage()[:48] for record in caplog.records] == [
        "kept machine code is damaged and compiled anew: "
    ]


def test_a_file_cut_or_changed_anywhere_is_never_taken(tmp_path: Path) -> None:
    """Every length, and a thousand changed bytes, of an index and of a file of code."""
    keeper = KeptCode(tmp_path, "f-1", "stamp", pickle.dumps)
    code = random.Random(1).randbytes(300)
    keeper.save("key", code)
    assert keeper.load("key") == code
    logging.getLogger("matchset").setLevel(logging.CRITICAL)
    try:
        for name in ("f-1.nbi", "f-1.1.nbc"):
            path, chance = tmp_path / name, random.Random(2)
            whole = path.read_bytes()
            for length in range(len(whole)):
                path.write_bytes(whole[:length])
                assert keeper.load("key") is None, length
                assert not path.exists(), length
            for _ in range(500):
                place, bits = chance.randrange(len(whole)), chance.randrange(1, 256)
                path.write_bytes(whole[:place] + bytes((whole[place] ^ bits,)) + whole[place + 1 :])
                assert keeper.load("key") is None, (place, bits)
            path.write_bytes(whole)
            assert keeper.load("key") == code
    finally:
        logging.getLogger("matchset").setLevel(logging.NOTSET)


def test_what_was_kept_for_another_source_counts_for_nothing(tmp_path: Path) -> None:
    KeptCode(tmp_path, "f-1", "old", pickle.dumps).save("key", "code")
    assert KeptCode(tmp_path, "f-1", "new", pickle.dumps).load("key") is None
    assert len(MAGIC) + CHECKSUM < (tmp_path / "f-1.1.nbc").stat().st_size


@pytest.mark.usefixtures("nothing_said")
def test_code_that_cannot_be_used_is_removed_and_said(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    keeper = KeptCode(tmp_path, "f-1", "stamp", pickle.dumps)
    keeper.save("key", "code")
    keeper.discard("key", ValueError("of another compiler"))
    assert "ValueError: of another compiler" in caplog.text
    assert keeper.load("key") is None
    keeper.save("key", "again")
    assert keeper.load("key") == "again"


KERNELS = """
from matchset.numeric.jit import kernel


@kernel
def double(x):
    return 2.0 * x


@kernel
def triple(x):
    return 3.0 * x
"""


class Kernels:
    """Two kernels of a user's file, as each process finds them anew.

    Parameters
    ----------
    file : Path
        The file.
    """

    def __init__(self, file: Path) -> None:
        file.write_text(KERNELS, encoding="utf-8")
        self._file = file

    def hits(self) -> int:
        """Call both; how many were found kept."""
        spec = importlib.util.spec_from_file_location("mine", self._file)
        assert spec is not None
        assert spec.loader is not None
        module: Any = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        assert (module.double(1.5), module.triple(1.5)) == (3.0, 4.5)
        return sum(sum(each.stats.cache_hits.values()) for each in (module.double, module.triple))


@pytest.fixture
def kernels(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, nothing_said: None) -> Kernels:
    """Kernels whose code is kept in `tmp_path / "cache"`."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "cache"))
    return Kernels(tmp_path / "mine.py")


def fill_disk(monkeypatch: pytest.MonkeyPatch) -> None:
    real = Path.open

    def full(path: Path, *more: Any, **named: Any) -> Any:
        if ".tmp." in path.name:
            real(path, *more, **named).close()  # a name still fits
            raise OSError(errno.ENOSPC, "No space left on device", str(path))
        return real(path, *more, **named)

    monkeypatch.setattr(Path, "open", full)


def forbid_writing(monkeypatch: pytest.MonkeyPatch) -> None:
    real = Path.open

    def refuse(path: Path, mode: str = "r", *more: Any, **named: Any) -> Any:
        if "r" not in mode:
            raise PermissionError(errno.EROFS, "Read-only file system", str(path))
        return real(path, mode, *more, **named)

    def refuse_folder(path: Path, *_more: Any, **_named: Any) -> None:
        raise PermissionError(errno.EROFS, "Read-only file system", str(path))

    monkeypatch.setattr(Path, "open", refuse)
    monkeypatch.setattr(Path, "mkdir", refuse_folder)


def test_where_the_disk_is_full_kernels_run_and_it_is_said_once(
    kernels: Kernels, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    fill_disk(monkeypatch)
    assert kernels.hits() == 0
    words = said(caplog)
    assert words.startswith(f"machine code cannot be kept in {tmp_path / 'cache'}")
    assert "No space left on device" in words
    assert not list(tmp_path.rglob("*.tmp.*"))


def test_where_no_folder_may_be_written_kernels_run_and_it_is_said_once(
    kernels: Kernels, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    """Read-only package, cache and home: folders cannot be made below a file, not even by the superuser."""
    (tmp_path / "cache").write_text("")
    assert kernels.hits() == 0
    words = said(caplog)
    assert words.startswith(f"machine code cannot be kept in {tmp_path / 'cache'}, each start compiles it anew: "), (
        words
    )
    assert "NUMBA_CACHE_DIR" in words


def test_a_folder_that_becomes_read_only_is_read_all_the_same(
    kernels: Kernels, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    assert kernels.hits() == 0
    folder = tmp_path / "cache"
    for path in [*folder.rglob("*"), folder]:
        path.chmod(stat.S_IREAD | (stat.S_IEXEC if path.is_dir() else 0))
    try:
        assert kernels.hits() == 2
    finally:
        for path in [folder, *folder.rglob("*")]:
            path.chmod(stat.S_IRWXU)
    assert not caplog.records


def test_what_was_kept_is_used_on_a_read_only_disk(
    kernels: Kernels, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """A container whose image has all kernels compiled: nothing may be written, and nothing is compiled."""
    assert kernels.hits() == 0
    forbid_writing(monkeypatch)
    assert kernels.hits() == 2
    assert not caplog.records


def test_a_read_only_disk_without_kept_code_is_said_once(
    kernels: Kernels, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    forbid_writing(monkeypatch)
    assert kernels.hits() == 0
    assert said(caplog).startswith("machine code cannot be kept in ")


def test_what_nobody_named_a_folder_for_is_in_the_cache_of_the_user(tmp_path: Path) -> None:
    environment = {name: value for name, value in os.environ.items() if name != "NUMBA_CACHE_DIR"}
    environment |= {"XDG_CACHE_HOME": str(tmp_path), "HOME": str(tmp_path), "LOCALAPPDATA": str(tmp_path)}
    program = "from matchset.numeric.kept_code import kept_root; print(kept_root())"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, env=environment, check=True)
    assert tmp_path in Path(done.stdout.strip()).parents


def test_copies_of_the_package_share_what_is_kept(kept: Path, tmp_path: Path) -> None:
    """Otherwise a second clone, or an installed package beside one, compiles everything again."""
    there = tmp_path / "elsewhere" / "matchset"
    shutil.copytree(PACKAGE, there, ignore=shutil.ignore_patterns("__pycache__", "app", "sim"))
    for file in there.rglob("*.py"):
        os.utime(file)
    where = "import matchset\nassert 'elsewhere' in matchset.__file__\n"
    assert run(kept, where + PROGRAM, PYTHONPATH=str(there.parent)) == (f"{SAME} 1", "")


def test_of_a_source_that_changes_the_newest_versions_are_kept(tmp_path: Path) -> None:
    for stamp in range(9):
        folder = tmp_path / f"a.first-{stamp:08x}"
        make_kept_folder(folder, versions=4)
        os.utime(folder, (stamp, stamp))
        make_kept_folder(tmp_path / "a.first.second-00000001", versions=4)
    left = sorted(path.name for path in tmp_path.iterdir())
    assert left == [
        "a.first-00000005",
        "a.first-00000006",
        "a.first-00000007",
        "a.first-00000008",
        "a.first.second-00000001",
    ]


def test_the_folder_of_a_file_follows_its_place_in_the_package(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    assert kept_folder(PACKAGE / "fitting" / "prior.py", 0xAB) == tmp_path / "fitting.prior-000000ab"
    assert kept_folder(Path("/mine/family.py"), 1) == tmp_path / "family-00000001"
