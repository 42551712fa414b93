"""The README tells the truth: its Python runs, its folders exist, its table is that of the results."""

import re
from pathlib import Path

import pytest
from benchmarks.readme import BEGIN, END, block

from matchset.app.films.clip_export import write_clip
from matchset.sim.clips.clip import Clip

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
RESULTS = (ROOT / "benchmarks" / "RESULTS.md").read_text(encoding="utf-8")
LONGEST = 160  # lines


def example(language: str, number: int = 0) -> str:
    found = re.findall(rf"```{language}\n(.*?)```", README, re.DOTALL)
    assert len(found) > number
    return str(found[number])


def folders(of: Path) -> set[str]:
    return {path.name for path in of.iterdir() if path.is_dir() and any(path.rglob("*.py"))}


def test_it_is_short() -> None:
    assert README.count("\n") <= LONGEST


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


def test_the_shapes_of_the_readme_can_be_made(capsys: pytest.CaptureFixture[str]) -> None:
    exec(compile(example("python", 1), "README.md", "exec"), {})
    assert "angle" in capsys.readouterr().out


def test_the_meters_of_the_readme_are_those_of_the_truth(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    clip = Clip(frames=8)
    write_clip(clip, tmp_path / "ball.mp4")
    monkeypatch.chdir(tmp_path)
    exec(compile(example("python", 2), "README.md", "exec"), {})
    (line,) = capsys.readouterr().out.splitlines()
    numbers = [float(number) for number in re.findall(r"-?\d+\.\d*(?:e-?\d+)?", line)]
    assert numbers[:3] == pytest.approx(clip.truth(0).position, abs=0.02)
    assert all(0.0 < sigma < 0.02 for sigma in numbers[3:6])


def test_every_folder_has_its_line() -> None:
    house = example("text")
    package = ROOT / "src" / "matchset"
    assert set(re.findall(r"^  (\w+)/ ", house, re.MULTILINE)) == folders(package)
    for folder in folders(package):
        line = re.search(rf"^  {folder}/ .*", house, re.MULTILINE)
        assert line is not None
        named = set(re.findall(r"(\w+)/", line[0])) - {folder}
        assert named == folders(package / folder), folder
    beside = re.findall(r"^(\w+)/ ", house, re.MULTILINE)
    tracked = {path.name for path in ROOT.iterdir() if path.is_dir() and not path.name.startswith(".")}
    assert set(beside) == (tracked & {"firmware", "benchmarks", "examples", "tests", "docs"})
    for folder in beside:
        line = re.search(rf"^{folder}/ .*", house, re.MULTILINE)
        assert line is not None
        assert all((ROOT / folder / name).is_dir() for name in set(re.findall(r"(\w+)/", line[0])) - {folder, "src"})
    assert folders(ROOT / "benchmarks") <= set(re.findall(r"(\w+)/", house))


def test_pages_that_the_readme_points_to_exist() -> None:
    links = re.findall(r"\]\(([^)#:]+)\)", README)
    assert links
    assert not [link for link in links if not (ROOT / link).exists()]


def test_the_table_is_that_of_the_results() -> None:
    shown = README.split(BEGIN)[1].split(END)[0].lstrip("\n")
    assert shown == block(RESULTS), "`python -m benchmarks.readme` fills it in again"


@pytest.mark.parametrize("text", [README, RESULTS], ids=["README", "RESULTS"])
def test_how_many_times_slower_is_the_quotient_of_the_times_beside_it(text: str) -> None:
    head, checked = [""], 0
    for line in text.splitlines():
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


def test_real_footage_is_attributed_and_small() -> None:
    shown = README[README.index("docs/pictures/real.webp") :][:900]
    for words in ("trflorian", "Ayşe Nur Akdeniz", "MIT license", "github.com/"):
        assert words in shown
    assert (ROOT / "docs" / "pictures" / "real.webp").stat().st_size < 200_000


def test_how_many_pixels_are_read_is_said_the_same_everywhere() -> None:
    package = (ROOT / "src" / "matchset" / "__init__.py").read_text(encoding="utf-8").splitlines()[0]
    project = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    assert all("about a thousand pixels" in text for text in (README, package, project))
    assert not any("few hundred pixels" in text for text in (README, package, project))
