"""The report: figures that can be checked by hand, pictures that open, names that are refused."""

import base64
import re
import shutil
import subprocess
from html.parser import HTMLParser
from pathlib import Path

import cv2
import msgspec
import numpy as np
import pytest

from chain_flight import Flown, descending, lost, with_crash, with_step, without_truth
from matchset.control.safety import SafetyState
from matchset.flight.fly.log import EXPLANATIONS, HEADINGS, PHASES, FlightLog, flight_summary, follower_row
from matchset.flight.fly.output_files import check_report
from matchset.flight.report import plots
from matchset.flight.report.parameter_table import parameter_rows
from matchset.flight.report.report import write_report
from plot_layout import faults


def log_of(flown: Flown) -> FlightLog:
    log = FlightLog(flown.setup)
    for chain_step in flown.chain_steps:
        log.add(chain_step)
    return log


def test_the_log_holds_the_numbers_of_the_steps(flown: Flown) -> None:
    log = log_of(flown)
    first = log.followers[0]
    steps = [chain_step.steps[0] for chain_step in flown.chain_steps]
    np.testing.assert_array_equal(first.time, [step.now for step in steps])
    np.testing.assert_array_equal(
        first.true_position, [chain_step.true_positions[0] for chain_step in flown.chain_steps]
    )
    control = steps[4].control
    assert control is not None
    assert first.estimated_position[4].tolist() == [control.side, control.height, control.heading]
    assert [PHASES[k] for k in first.phase] == [step.safety.phase for step in steps]
    np.testing.assert_array_equal(np.isnan(first.processing), [step.frame is None for step in steps])
    assert log.balls_in_room.shape == (len(steps), 3, 3)
    assert np.abs(first.estimated_in_chain - first.true_in_chain)[:10].max() < 0.3
    assert np.isnan(first.estimated_in_chain[-1]).all()
    assert float(np.nanmedian(first.circle_error_px)) < 1.5


def test_the_figures_are_in_the_order_of_their_headings(flown: Flown) -> None:
    log = log_of(flown)
    figures = dict(zip(HEADINGS, follower_row(log, 0), strict=True))
    assert figures[""] == "1 watches 2"
    assert figures["pictures"] == str(sum(chain_step.steps[0].frame is not None for chain_step in flown.chain_steps))
    assert figures["ball found"].endswith("%")
    assert figures["losses"] == "1"
    assert figures["at the end"] == flown.chain_steps[-1].steps[0].safety.phase
    assert figures["off the set place, cm"] == "-"  # it is too short
    assert "nobody crashed" in flight_summary(log)
    computing = 1e6 * log.followers[0].processing
    computing = computing[np.isfinite(computing)]
    four = np.median(computing), computing.mean(), np.percentile(computing, 95), computing.max()
    assert figures["computing, µs"] == ", ".join(f"{each:.0f}" for each in four)
    assert EXPLANATIONS[HEADINGS.index("computing, µs")] == "median, mean, 95 %, worst"
    ages = figures["age, ms"].split(", ")
    assert len(ages) == 4
    assert float(ages[0]) <= float(ages[2]) <= float(ages[3])


def test_the_plot_of_the_computing_time_says_more_than_its_median(flown: Flown) -> None:
    titles = [axes.get_title(loc="left") for axes in plots.computing_figure(log_of(flown)).axes]
    assert "median, mean, 95 %, worst" in titles[0]
    assert all(re.search(r"\d watches \d: \S+, \S+, \S+, \S+ µs$", each) for each in titles)
    others = [axes.get_title(loc="left") for axes in plots.circle_error_figure(log_of(flown)).axes]
    assert all(re.search(r"median \S+ px$", each) for each in others)


def test_the_verdict_names_who_crashed_or_came_down(flown: Flown) -> None:
    log = log_of(flown)
    log.add(with_crash(flown.chain_steps[-1]))
    assert "vehicle 1 hit the floor at 0.8 s" in flight_summary(log)
    assert follower_row(log, 0)[-1] == "hit the floor at 0.8 s"
    assert flight_summary(FlightLog(flown.setup)) == "nothing was flown"


class Structure(HTMLParser):
    """The tags of a page with their attributes, and the texts of its first cells."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.inside: list[str] = []
        self.folded: set[str] = set()
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        self.inside.append(tag)

    def handle_endtag(self, tag: str) -> None:
        if tag in self.inside:
            del self.inside[len(self.inside) - 1 - self.inside[::-1].index(tag) :]

    def handle_data(self, data: str) -> None:
        if "details" in self.inside and data.strip():
            self.folded.add(data.strip())

    def all(self, tag: str) -> list[dict[str, str | None]]:
        return [attributes for name, attributes in self.tags if name == tag]


@pytest.fixture(scope="module")
def page(flown: Flown, tmp_path_factory: pytest.TempPathFactory) -> Path:
    log, path = log_of(flown), tmp_path_factory.mktemp("report") / "flight.html"
    chain_step = flown.chain_steps[3]
    log.add(with_step(chain_step, 0, descending(lost(chain_step.steps[0]))))
    write_report(log, path)
    assert list(path.parent.iterdir()) == [path]
    return path


def test_a_report_is_one_file_with_its_plots_and_pictures_in_it(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    found = Structure(text)
    plots = found.all("svg")
    assert len(plots) == 7  # two of paths, two followers, errors of the circle, age, computing
    for plot in plots:
        assert plot["viewbox"]
        assert "width" not in plot
        assert "height" not in plot
    names = [name for _, attributes in found.tags if (name := attributes.get("id"))]
    assert len(names) == len(set(names))
    pictures = [str(each["src"]).partition("base64,")[2] for each in found.all("img")]
    assert len(pictures) == 2  # a camera of each follower
    for each in pictures:
        image = cv2.imdecode(np.frombuffer(base64.b64decode(each), np.uint8), cv2.IMREAD_COLOR)
        assert image is not None
        assert image.shape == (480, 640, 3)
        blue, green, red = image.astype(int).transpose(2, 0, 1)
        assert ((red - green > 60) & (blue - green > 40)).sum() > 100  # the outline
    assert "1 watches 2" in text
    assert "http" not in text  # nothing is fetched


def test_a_report_fits_a_phone_a_dark_room_and_paper(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    found = Structure(text)
    assert {"name": "viewport", "content": "width=device-width, initial-scale=1"} in found.all("meta")
    assert text.count("prefers-color-scheme") >= 2
    assert "@media print" in text
    assert all(len(heading) <= 24 for heading in HEADINGS)
    assert len(EXPLANATIONS) == len(HEADINGS)
    assert len(found.all("details")) == 1
    assert {"world.seed", "pilot.place.heading", "m/s^2", "degree", "set place above the ball"} <= {
        each.partition(",")[0] for each in found.folded
    }


@pytest.mark.skipif(not shutil.which("chromium"), reason="no chromium here")
def test_nothing_of_a_report_is_wider_than_the_window(page: Path, tmp_path: Path) -> None:
    """The page stands in frames of these widths: a browser's own window has a least width."""
    widths = 420, 1200
    measure = "<script>onload=()=>parent.postMessage([innerWidth,document.documentElement.scrollWidth],'*')</script>"
    (tmp_path / "inner.html").write_text(page.read_text(encoding="utf-8") + measure, encoding="utf-8")
    receive = "<script>document.title='wide';onmessage=each=>document.title+=' '+each.data</script>"
    frames = "".join(f"<iframe width={width} height=900 src=inner.html></iframe>" for width in widths)
    (tmp_path / "outer.html").write_text(receive + frames)
    options = ["--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={tmp_path / 'user'}"]
    asked = [*options, "--virtual-time-budget=20000", "--dump-dom", (tmp_path / "outer.html").as_uri()]
    shown = subprocess.run(["chromium", *asked], capture_output=True, text=True, timeout=120, check=True).stdout
    wide = {int(width): int(found) for width, found in re.findall(r"(\d+),(\d+)", shown.partition("</title>")[0])}
    assert tuple(sorted(wide)) == widths
    assert all(found <= width for width, found in wide.items())


def test_every_plot_of_a_report_is_laid_out_well(flown: Flown) -> None:
    log = log_of(flown)
    drawn = [plots.room_figure(log), plots.chain_figure(log), plots.circle_error_figure(log), plots.age_figure(log)]
    drawn += [plots.computing_figure(log), *(plots.coordinates_figure(log, k) for k in range(2))]
    assert not [fault for figure in drawn for fault in faults(figure)]


def test_a_thinned_line_keeps_its_extremes_and_its_gaps() -> None:
    time = np.arange(10_000, dtype=float)
    values = np.sin(time / 700.0)
    values[4321], values[7777], values[5000:5100] = 9.0, -9.0, np.nan
    some, kept = plots.thin(time, values, 500)
    assert len(kept) <= 800
    assert (np.nanmax(kept), np.nanmin(kept)) == (9.0, -9.0)
    assert np.isnan(kept[(some >= 5000) & (some < 5100)]).any()
    assert plots.thin(time[:100], values[:100])[0] is not None
    np.testing.assert_array_equal(plots.thin(time[:100], values[:100])[1], values[:100])


def test_every_parameter_has_a_unit_or_a_meaning(flown: Flown) -> None:
    rows = {row.key: row for row in parameter_rows(flown.setup.parameters)}
    assert rows["world.latency_ms"].unit == "ms"
    assert rows["world.vehicle.mass"].unit == "kg"
    assert rows["pilot.follower.horizontal.output_limit"].meaning == "limit of the output"
    assert rows["world.seed"].changed
    assert not rows["world.vehicles"].changed
    silent = [key for key, row in rows.items() if not row.meaning]
    assert silent == ["world.model", "pilot.excitation"]  # a measured camera, shaken sticks: where they were given


def test_a_flight_that_never_began_has_a_report_too(flown: Flown, tmp_path: Path) -> None:
    write_report(FlightLog(flown.setup), tmp_path / "flight.html")
    assert "nothing was flown" in (tmp_path / "flight.html").read_text(encoding="utf-8")


def test_other_names_are_refused() -> None:
    check_report(Path("a.HTML"))
    with pytest.raises(ValueError, match=r"must end in \.html, got 'flight\.pdf'"):
        check_report(Path("flight.pdf"))


def test_a_real_flight_has_a_report_without_a_truth(flown: Flown, tmp_path: Path) -> None:
    log = log_of(without_truth(flown))
    path = tmp_path / "flight.html"
    write_report(log, path)
    page = path.read_text(encoding="utf-8")
    assert "<h1>A flight</h1>" in page
    assert "vehicle 1: camera 0, serial:///dev/ttyUSB0; vehicle 2: camera 1" in page
    assert "of all pictures" in page
    assert "by its own eyes" in page
    assert "world.seed" not in page
    assert "truth" not in re.sub(r"<style>.*?</style>", "", page, flags=re.DOTALL)
    figures = dict(zip(HEADINGS, follower_row(log, 0), strict=True))
    assert figures["circle error, px"] == "-"
    assert np.isnan(log.followers[0].true_position).all()


def test_a_dry_run_says_so(flown: Flown, tmp_path: Path) -> None:
    write_report(log_of(without_truth(flown, "dry run")), tmp_path / "dry.html")
    assert "<h1>A dry run: no throttle was sent</h1>" in (tmp_path / "dry.html").read_text(encoding="utf-8")


def test_nobody_who_stayed_on_the_ground_has_flown(flown: Flown) -> None:
    real = without_truth(flown)
    locked = SafetyState()
    log = FlightLog(real.setup)
    for chain_step in real.chain_steps:
        steps = tuple(msgspec.structs.replace(step, safety=locked) for step in chain_step.steps)
        log.add(msgspec.structs.replace(chain_step, steps=steps))
    assert flight_summary(log).endswith("; nobody took off")
