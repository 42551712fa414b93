"""The style of plots: names beside lines never touch, numbers can be read, SVG follows light and dark."""

import re
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest

from matchset.app.drawing.plot_style import (
    DARK,
    INK,
    OURS,
    PAPER,
    SERIES,
    LineLabel,
    apart,
    color_rules,
    figure_of,
    label_lines,
    linear_ticks,
    log_ticks,
    rolling,
    svg_of,
    title,
    write_svg,
)
from plot_layout import faults, numbers_at


def luminance(color: str) -> float:
    """Relative luminance of a color, as WCAG 2 defines it."""
    parts = [int(color[k : k + 2], 16) / 255.0 for k in (1, 3, 5)]
    linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one: str, other: str) -> float:
    a, b = sorted((luminance(one), luminance(other)))
    return (b + 0.05) / (a + 0.05)


def test_numbers_move_apart_as_little_as_possible_and_stay_within() -> None:
    assert apart([10.0, 50.0, 90.0], 15.0, (0.0, 100.0)) == [10.0, 50.0, 90.0]
    assert apart([50.0, 50.0, 50.0], 10.0, (0.0, 100.0)) == [40.0, 50.0, 60.0]
    assert apart([99.0, 100.0], 10.0, (0.0, 100.0)) == [90.0, 100.0]
    assert apart([0.0, 1.0, 60.0], 10.0, (0.0, 100.0)) == [0.0, 10.0, 60.0]
    assert apart([], 10.0, (0.0, 1.0)) == []
    rng = np.random.default_rng(0)
    for _ in range(50):
        places = np.sort(rng.uniform(0.0, 100.0, 6))
        moved = np.array(apart(places.tolist(), 12.0, (0.0, 100.0)))
        assert (np.diff(moved) >= 12.0 - 1e-9).all()
        assert moved.min() >= -1e-9
        assert moved.max() <= 100.0 + 1e-9


def test_names_beside_lines_that_end_together_touch_nothing() -> None:
    figure, (axes,) = figure_of((700, 300))
    for k in range(7):
        axes.plot([0.0, 1.0, 2.0], [k, 3.0, 3.0 + 0.01 * k], color=SERIES[k % len(SERIES)])
    title(axes, "seven lines")
    label_lines(axes, [LineLabel(f"a line called {k}", 3.0 + 0.01 * k, SERIES[k % 7], k == 0) for k in range(7)])
    assert not faults(figure)


def test_the_layout_check_sees_what_is_wrong() -> None:
    figure, (axes,) = figure_of((700, 300))
    axes.plot([0.0, 1.0], [0.0, 1.0])
    axes.text(0.5, 0.5, "one text")
    axes.text(0.5, 0.52, "another text")
    axes.annotate("far out", (1.0, 0.5), xytext=(300, 0), textcoords="offset points", annotation_clip=False)
    axes.set_yticks([0.0, 1.0])
    figure.set_layout_engine("none")
    axes.set_position((0.1, 0.1, 0.3, 0.8))
    found = " | ".join(faults(figure))
    for words in (
        "'one text' lies on 'another text'",
        "'far out' is cut off",
        "2 numbers at the y axis",
        "30 % of the",
    ):
        assert words in found


@pytest.mark.parametrize(("low", "high"), [(1.0, 9.0), (0.03, 0.7), (0.2, 40.0), (0.01, 100.0), (70.0, 200000.0)])
def test_logarithmic_axes_have_three_numbers_or_more(low: float, high: float) -> None:
    figure, (axes,) = figure_of((600, 300))
    axes.plot([1.0, 2.0], [low, high])
    log_ticks(axes.yaxis, low, high)
    linear_ticks(axes.xaxis)
    assert not faults(figure)
    assert 3 <= len(numbers_at(axes.yaxis)) <= 8
    assert axes.get_ylim() == pytest.approx((low, high))


def test_a_rolling_median_leaves_gaps_out() -> None:
    nan = float("nan")
    np.testing.assert_array_equal(rolling([1.0, 9.0, 2.0, 3.0, 4.0], 3, 50.0), [5.0, 2.0, 3.0, 3.0, 3.5])
    np.testing.assert_array_equal(rolling([1.0, nan, nan, nan, 5.0], 3, 50.0), [1.0, 1.0, nan, 5.0, 5.0])


def test_every_color_has_a_counterpart_that_can_be_read_on_dark() -> None:
    assert {INK, PAPER, OURS, *SERIES} <= set(DARK)
    assert len(set(DARK.values())) == len(DARK)
    assert contrast(INK, PAPER) > 7.0
    assert contrast(DARK[INK], DARK[PAPER]) > 7.0
    for color in (OURS, *SERIES):
        assert contrast(DARK[color], DARK[PAPER]) > 3.0  # WCAG 2, graphics
    assert contrast(OURS, PAPER) > 3.0


def test_svg_follows_light_and_dark_and_is_the_same_each_time(tmp_path: Path) -> None:
    def plot() -> str:
        figure, (axes,) = figure_of((600, 300))
        axes.plot([0.0, 1.0, 2.0], [1.123456789, 2.0, 3.0], "o-", color=OURS)
        title(axes, "a title")
        write_svg(figure, tmp_path / "plot.svg")
        return (tmp_path / "plot.svg").read_text(encoding="utf-8")

    text = plot()
    assert text == plot()
    assert "prefers-color-scheme:dark" in text
    assert f"var(--plot-{list(DARK).index(OURS)})" in text
    rules = color_rules("svg")
    drawn = text.replace(rules, "")
    assert not [color for color in DARK if color in drawn]
    root = ET.fromstring(text)
    assert root.attrib["viewBox"].split()[2:] == ["432", "216"]
    assert "2026" not in text  # no date


def test_svg_inside_a_page_scales_and_its_names_are_its_own() -> None:
    parts = []
    for name in ("one", "two"):
        figure, (axes,) = figure_of((600, 300))
        axes.plot([0.0, 1.0, 2.0], [1.0, 2.0, 3.0], "o-", color=OURS)
        title(axes, "words stay text")
        parts.append(svg_of(figure, name, inside=True))
    for part in parts:
        opening = part[: part.index(">")]
        assert not re.search(r"\b(width|height)=", opening)
        assert "viewBox" in opening
        assert "words stay text" in part
        assert "--plot-0:" not in part  # the page sets the colors
    names = [set(re.findall(r'\bid="([^"]+)"', part)) for part in parts]
    assert names[0]
    assert not names[0] & names[1]
    for part, known in zip(parts, names, strict=True):
        assert set(re.findall(r'(?:url\(#|href="#)([^")]+)', part)) <= known
