"""Words and controls of the page can be read: the ratios of WCAG 2.2 AA, from the colors in its style sheets."""

import itertools
import re
from pathlib import Path

import pytest

import matchset.live

PAGE = Path(matchset.live.__file__).parent / "page"
COLOR = re.compile(r"--([\w-]+):\s*#([0-9a-f]{6})\b")
TEXT, CONTROL = 4.5, 3.0  # WCAG 1.4.3 and 1.4.11
GROUNDS = ("page", "panel")
WORDS = ("ink", "soft", "accent", "warn", "good", "danger")


def palettes() -> dict[str, dict[str, str]]:
    """The colors of both schemes by their names."""
    light, dark = (PAGE / "style.css").read_text().split("prefers-color-scheme: dark", 1)
    found = {"light": dict(COLOR.findall(light)), "dark": dict(COLOR.findall(dark))}
    assert found["light"].keys() == found["dark"].keys()
    return found


def luminance(color: str) -> float:
    """Relative luminance of sRGB as six hexadecimal digits."""
    parts = [int(color[i : i + 2], 16) / 255.0 for i in (0, 2, 4)]
    red, green, blue = (part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts)
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


def contrast(one: str, other: str) -> float:
    """Ratio of the two, 1 ... 21."""
    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


def test_the_ratio_is_that_of_the_standard() -> None:
    assert contrast("ffffff", "000000") == pytest.approx(21.0)
    assert contrast("767676", "ffffff") == pytest.approx(4.54, abs=0.005)


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_words_can_be_read_on_every_ground(scheme: str) -> None:
    colors = palettes()[scheme]
    for word, ground in itertools.product(WORDS, GROUNDS):
        assert contrast(colors[word], colors[ground]) >= TEXT, (word, ground)
    assert contrast(colors["on-accent"], colors["accent"]) >= TEXT


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_edges_of_controls_and_the_focus_can_be_seen(scheme: str) -> None:
    colors = palettes()[scheme]
    for name, ground in itertools.product(("edge", "accent"), GROUNDS):
        assert contrast(colors[name], colors[ground]) >= CONTROL, (name, ground)


def test_all_colors_that_are_named_exist() -> None:
    scripts = "".join(script.read_text() for script in PAGE.rglob("*.js"))
    known = set(palettes()["light"]) | set(re.findall(r'setProperty\("--([\w-]+)"', scripts))
    for sheet in PAGE.rglob("*.css"):
        text = sheet.read_text()
        named = set(re.findall(r"var\(--([\w-]+)", text)) - set(re.findall(r"--([\w-]+):", text))
        assert named <= known, (sheet.name, named - known)
