from pathlib import Path

import pytest

from matchset.app.run_folder import output_file, output_folder


def test_every_run_gets_a_new_number(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    made = [output_folder(None, "track"), output_folder(None, "learn")]
    (tmp_path / "runs" / "0041-track").mkdir()
    made.append(output_folder(None, "demo"))
    assert [folder.as_posix() for folder in made] == ["runs/0001-track", "runs/0002-learn", "runs/0042-demo"]


def test_a_folder_with_files_is_left_alone(tmp_path: Path) -> None:
    folder = tmp_path / "out"
    assert output_folder(folder, "track") == folder
    assert output_folder(folder, "track") == folder  # still empty
    (folder / "mine.txt").write_text("mine")
    with pytest.raises(ValueError, match="not empty: choose another, or overwrite with --force"):
        output_folder(folder, "track")
    assert output_folder(folder, "track", force=True) == folder
    assert (folder / "mine.txt").read_text() == "mine"


def test_what_cannot_be_written_is_said(tmp_path: Path) -> None:
    file = tmp_path / "file"
    file.write_text("")
    with pytest.raises(ValueError, match="is a file, not a folder"):
        output_folder(file, "track")
    with pytest.raises(ValueError, match="cannot write to the folder"):
        output_folder(file / "below", "track")
    with pytest.raises(ValueError, match="cannot write"):
        output_file(file / "below.mp4")
    with pytest.raises(ValueError, match="is a folder, not a file"):
        output_file(tmp_path)


def test_a_file_is_overwritten_only_by_force(tmp_path: Path) -> None:
    path = tmp_path / "new" / "out.mp4"
    assert output_file(path) == path
    path.write_text("old")
    with pytest.raises(ValueError, match="exists: choose another name"):
        output_file(path)
    assert output_file(path, force=True) == path
    assert path.read_text() == "old"


def test_runs_that_is_a_file_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("runs").write_text("")
    with pytest.raises(ValueError, match="cannot write to the folder runs"):
        output_folder(None, "track")


@pytest.mark.parametrize("link", ["itself", "symbolic", "hard", "folder", "pattern"])
def test_what_is_read_is_never_overwritten(tmp_path: Path, link: str) -> None:
    film = tmp_path / "film" / "0001.png"
    film.parent.mkdir()
    film.write_text("a film")
    wanted = film if link in ("itself", "folder", "pattern") else tmp_path / "out.png"
    if link == "symbolic":
        wanted.symlink_to(film)
    elif link == "hard":
        wanted.hardlink_to(film)
    source = {"folder": film.parent, "pattern": film.parent / "%04d.png"}.get(link, film)
    with pytest.raises(ValueError, match="is what is read"):
        output_file(wanted, force=True, source=source)
    assert film.read_text() == "a film"
    assert output_file(film.parent / "new.png", force=True, source=source) == film.parent / "new.png"
