"""README and ARCHITECTURE tell the truth: the Python runs, the folders exist, the table is that of the results."""

import re
from pathlib import Path

import pytest
from benchmarks.readme import BEGIN, END, block
from PIL import Image, ImageSequence

from matchset.app.films.clip_export import write_clip
from matchset.sim.clips.clip import Clip

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
ARCHITECTURE = (ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8")
RESULTS = (ROOT / "benchmarks" / "RESULTS.md").read_text(encoding="utf-8")
LONGEST = 110  # lines
WORDS = 1000  # of the whole file, tables included: it is skimmed in a minute


def example(language: str, text: str = README) -> str:
    (found,) = re.findall(rf"```{language}\n(.*?)```", text, re.DOTALL)
    return str(found)


def folders(of: Path) -> set[str]:
    return {path.name for path in of.iterdir() if path.is_dir() and any(path.rglob("*.py"))}


def test_it_is_short() -> None:
    assert README.count("\n") <= LONGEST
    assert len(README.split()) <= WORDS
    tables = [line for line in README.splitlines() if line.startswith("|")]
    assert all(line.count(" | ") <= 3 for line in tables), "four columns fit on a phone"


def test_the_python_of_the_readme_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    clip = Clip(frames=12)
    write_clip(clip, tmp_path / "ball.mp4")
    monkeypatch.chdir(tmp_path)
    exec(compile(example("python"), "README.md", "exec"), {})
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == len(clip)
    for index, line in enumerate(lines):
        truth = clip.truth(index).circle
        assert truth is not None
        found = [float(number) for number in re.findall(r"=(-?[\d.]+)", line)]
        assert found == pytest.approx([truth.x, truth.y, truth.radius], abs=3.0)


def test_every_folder_has_its_line() -> None:
    house = example("text", ARCHITECTURE)
    package = ROOT / "src" / "matchset"
    assert set(re.findall(r"^  (\w+)/ ", house, re.MULTILINE)) == folders(package)
    for folder in folders(package):
        line = re.search(rf"^  {folder}/ .*", house, re.MULTILINE)
        assert line is not None
        named = set(re.findall(r"(\w+)/", line[0])) - {folder}
        assert named == folders(package / folder), folder
    beside = re.findall(r"^(\w+)/ ", house, re.MULTILINE)
    tracked = {path.name for path in ROOT.iterdir() if path.is_dir() and not path.name.startswith(".")}
    assert set(beside) == (tracked & {"firmware", "benchmarks", "training", "examples", "tests", "docs"})
    for folder in beside:
        line = re.search(rf"^{folder}/ .*", house, re.MULTILINE)
        assert line is not None
        assert all((ROOT / folder / name).is_dir() for name in set(re.findall(r"(\w+)/", line[0])) - {folder, "src"})
    assert folders(ROOT / "benchmarks") | folders(ROOT / "training") <= set(re.findall(r"(\w+)/", house))


def test_pages_that_the_readme_points_to_exist() -> None:
    links = re.findall(r"\]\(([^)#:]+)\)", README)
    assert links
    assert not [link for link in links if not (ROOT / link).exists()]


def test_the_table_is_that_of_the_results() -> None:
    shown = README.split(BEGIN)[1].split(END)[0].lstrip("\n")
    assert shown == block(RESULTS), "`python -m benchmarks.readme` fills it in again"


def test_how_many_times_slower_is_the_quotient_of_the_times_beside_it() -> None:
    head, checked = [""], 0
    for line in RESULTS.splitlines():
        cells = [cell.strip() for cell in line.strip("|").split(" | ")] if line.startswith("|") else []
        if "× ours" in cells:
            head = cells
        elif len(cells) == len(head) and "---" not in line and "× ours" in head:
            row = dict(zip(head, cells, strict=True))
            times = [row[name].removesuffix(" µs") for name in ("time", "matchset beside it", "× ours")]
            time, beside, ratio = (float(text.replace(",", "")) for text in times)
            assert (time - 0.5) / (beside + 0.5) - 0.05 <= ratio <= (time + 0.5) / (beside - 0.5) + 0.05, row
            checked += 1
    assert checked >= 8


def test_what_is_said_of_real_clips_is_what_was_measured() -> None:
    measured = re.search(
        r"real clips, one click each: valid [^|]*\| mean valid ([\d.]+) %, least valid ([\d.]+) %", RESULTS
    )
    assert measured is not None
    mean, least = (round(float(text)) for text in measured.groups())
    said = " ".join(README.split())
    assert f"{mean} % of the labelled frames are right in the mean, {least} % in the worst clip" in said


def test_the_environment_is_entered_before_the_first_command() -> None:
    lines = [line.strip() for line in README.splitlines() if line.startswith("    ")]
    first = next(k for k, line in enumerate(lines) if line.startswith("matchset "))
    assert ". .venv/bin/activate" in lines[:first]
    assert any(line.startswith("make demo") for line in lines[:first])
    made = next(k for k, line in enumerate(lines) if line.startswith("python examples/render_clip.py"))
    assert not [line for line in lines[:made] if "ball.mp4" in line], "the file is made before it is named"


def test_the_real_ball_moves_is_attributed_and_small() -> None:
    """All whose clips are shown are named beside the picture; it is kept below what a page of this kind may weigh."""
    shown = README[README.index("docs/pictures/real.webp") :][:400]
    clips = (ROOT / "docs" / "pictures" / "real.py").read_text(encoding="utf-8")
    owners = re.findall(r"# github\.com/(\w+)/", clips)
    assert owners
    for words in (*owners, "MIT license", "github.com/"):
        assert words in shown
    path = ROOT / "docs" / "pictures" / "real.webp"
    assert path.stat().st_size < 400_000
    with Image.open(path) as picture:
        assert sum(1 for _ in ImageSequence.Iterator(picture)) >= 30
        assert picture.info["loop"] == 0


def test_how_many_pixels_are_read_is_said_the_same_everywhere() -> None:
    package = (ROOT / "src" / "matchset" / "__init__.py").read_text(encoding="utf-8").splitlines()[0]
    project = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    assert all("about a thousand pixels" in text for text in (README, package, project))
    assert not any("few hundred pixels" in text for text in (README, package, project))
