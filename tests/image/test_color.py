from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt
import pytest

import matchset as ms
from matchset.image.color import LIMIT, WHITE

Picture = npt.NDArray[np.uint8]
RED, GREEN, BLUE = (30, 25, 200), (40, 180, 60), (200, 70, 30)
CENTERS = {"red": (60, 50), "green": (150, 60), "blue": (100, 130)}
RADIUS = 28


def picture(gray: bool = False) -> Picture:
    """A red, a green and a blue disc before a noisy wall."""
    rng = np.random.default_rng(0)
    image = np.full((180, 220, 3), 130, np.uint8)
    for color, center in zip((RED, GREEN, BLUE), CENTERS.values(), strict=True):
        cv2.circle(image, center, RADIUS, color, cv2.FILLED)
    noisy = np.rint(image + rng.normal(0.0, 6.0, image.shape)).clip(0, 255).astype(np.uint8)
    return cv2.cvtColor(noisy, cv2.COLOR_BGR2GRAY).astype(np.uint8) if gray else noisy


def disc(name: str, radius: float = RADIUS) -> npt.NDArray[np.bool_]:
    rows, columns = np.indices((180, 220))
    x, y = CENTERS[name]
    inside: npt.NDArray[np.bool_] = np.hypot(columns - x, rows - y) <= radius
    return inside


def hits(color: ms.ColorModel, image: Picture, name: str) -> tuple[float, float]:
    """Share of the disc, and of all that is not the disc, that looks like the target."""
    mask = color.mask(image) == 255
    return float(mask[disc(name, RADIUS - 2)].mean()), float(mask[~disc(name, RADIUS + 2)].mean())


@pytest.mark.parametrize("name", list(CENTERS))
@pytest.mark.parametrize("away", [(0, 0), (-14, 0), (9, 12), (0, -23)])
def test_one_click_is_enough(name: str, away: tuple[int, int]) -> None:
    x, y = CENTERS[name]
    inside, outside = hits(ms.ColorModel.pick(picture(), x + away[0], y + away[1]), picture(), name)
    assert inside > 0.98
    assert outside < 0.01


@pytest.mark.parametrize("gray", [False, True])
def test_a_region_is_enough(gray: bool) -> None:
    x, y = CENTERS["red"]
    color = ms.ColorModel.learn(picture(gray), (x - 10, y - 8, 20, 16))
    assert color.channels == (1 if gray else 3)
    inside, outside = hits(color, picture(gray), "red")
    assert inside > 0.95
    assert outside < 0.25  # another disc may be as gray


@pytest.mark.parametrize("gain", [0.55, 0.75, 1.25])
def test_lightness_hardly_matters(gain: float) -> None:
    image = picture()
    color = ms.ColorModel.pick(image, *CENTERS["blue"])
    lit = np.rint(gain * image.astype(float)).clip(0, 255).astype(np.uint8)
    inside, outside = hits(color, lit, "blue")
    assert inside > 0.9
    assert outside < 0.02


@pytest.mark.parametrize("name", list(CENTERS))
def test_hsv_ranges_are_those_of_opencv(name: str) -> None:
    hue = {"red": (170, 10), "green": (45, 75), "blue": (95, 125)}[name]
    low, high = (hue[0], 90, 60), (hue[1], 255, 255)
    inside, outside = hits(ms.ColorModel.hsv(low, high), picture(), name)
    assert inside > 0.98
    assert outside < 0.01


def test_hsv_agrees_with_opencv_pixel_by_pixel() -> None:
    rng = np.random.default_rng(3)
    image = rng.integers(0, 256, (200, 200, 3), np.uint8)
    hsv = cv2.cvtColor(image, cv2.COLOR_BGR2HSV)
    for low, high in (((95, 80, 40), (125, 255, 255)), ((170, 100, 0), (9, 255, 200))):
        h, s, v = cv2.split(hsv)
        hue = (h >= low[0]) & (h <= high[0]) if low[0] <= high[0] else (h >= low[0]) | (h <= high[0])
        wanted = hue & (s >= low[1]) & (s <= high[1]) & (v >= low[2]) & (v <= high[2])
        mask = ms.ColorModel.hsv(low, high).mask(image) == 255
        assert (mask == wanted).mean() > 0.96  # cells of 8 x 8 x 8 values


@pytest.mark.parametrize(
    ("low", "high", "words"),
    [
        ((-1, 0, 0), (9, 9, 9), r"got \(-1, 0, 0\)"),
        ((0, 0, 0), (180, 9, 9), r"got \(180, 9, 9\)"),
        ((0, 0, 0), (9, 256, 9), r"got \(9, 256, 9\)"),
        ((0, 9, 0), (9, 8, 9), r"low \(0, 9, 0\) lies above high \(9, 8, 9\)"),
        ((0, 0, 9), (9, 8, 8), "lies above"),
    ],
)
def test_hsv_out_of_range(low: tuple[int, int, int], high: tuple[int, int, int], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        ms.ColorModel.hsv(low, high)


def test_the_union_is_either_color() -> None:
    image = picture()
    red, blue = (ms.ColorModel.pick(image, *CENTERS[name]) for name in ("red", "blue"))
    both = red | blue
    np.testing.assert_array_equal(both.log_odds, np.maximum(red.log_odds, blue.log_odds))
    np.testing.assert_array_equal(both.mask(image), np.maximum(red.mask(image), blue.mask(image)))
    gray = ms.ColorModel(np.zeros(256, np.float32))
    with pytest.raises(ValueError, match="cannot be joined"):
        red | gray
    with pytest.raises(TypeError):
        red | 3  # type: ignore[operator]


def test_the_table_is_the_whiteness_of_the_log_odds() -> None:
    odds = np.linspace(-9.0, 9.0, 256, dtype=np.float32)
    color = ms.ColorModel(odds)
    assert color.channels == 1
    assert (color.log_odds.min(), color.log_odds.max()) == (-LIMIT, LIMIT)
    expected = np.rint(WHITE * np.tanh(0.5 * np.clip(odds, -LIMIT, LIMIT)))
    np.testing.assert_array_equal(color.table, expected)
    assert color.table.dtype == np.int8


def test_the_cell_of_a_pixel_is_its_five_upper_bits() -> None:
    for blue, green, red in ((0, 0, 0), (255, 128, 7), (9, 250, 77)):
        odds = np.full(32768, -4.0, np.float32)
        odds[blue // 8 * 1024 + green // 8 * 32 + red // 8] = 4.0
        image = np.array([[[blue, green, red], [blue ^ 8, green, red], [blue, green ^ 8, red], [blue, green, red ^ 8]]])
        assert ms.ColorModel(odds).mask(image.astype(np.uint8)).tolist() == [[255, 0, 0, 0]]


@pytest.mark.parametrize(
    "odds", [np.zeros(255), np.zeros((256, 1)), np.full(256, np.nan), np.full(32768, np.inf), np.zeros(0)]
)
def test_a_table_has_one_of_two_sizes_and_finite_numbers(odds: npt.NDArray[np.float32]) -> None:
    with pytest.raises(ValueError, match=r"got shape \("):
        ms.ColorModel(odds)


def test_a_copy_is_independent() -> None:
    color = ms.ColorModel(np.zeros(256, np.float32))
    color.copy().log_odds[:] = 1.0
    assert not color.log_odds.any()


# files


def test_what_is_saved_is_loaded(tmp_path: Path) -> None:
    color = ms.ColorModel.pick(picture(), *CENTERS["green"])
    for name in ("ball.npz", "ball"):
        color.save(tmp_path / name)
        loaded = ms.ColorModel.load(str(tmp_path / name))
        np.testing.assert_array_equal(loaded.log_odds, color.log_odds)
        np.testing.assert_array_equal(loaded.table, color.table)
        assert loaded.sample is not None
        assert color.sample is not None
        np.testing.assert_array_equal(loaded.sample.image, color.sample.image)
        assert loaded.sample[1:] == color.sample[1:]
        assert loaded.circle is None, "where it was, it need not be in another picture"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["ball", "ball.npz"]


def test_a_file_without_a_sample_is_loaded(tmp_path: Path) -> None:
    odds = np.zeros(256, np.float32)
    assert ms.ColorModel.load(archive(tmp_path / "a.npz", matchset_color=np.int64(1), log_odds=odds)).sample is None
    joined = ms.ColorModel(odds)
    joined.save(tmp_path / "b.npz")
    assert ms.ColorModel.load(tmp_path / "b.npz").sample is None


@pytest.mark.parametrize(
    ("sample", "circle"),
    [
        (np.zeros((9, 9, 3), np.float32), (4.0, 4.0, 2.0, 2.0)),
        (np.zeros((9, 9), np.uint8), (4.0, 4.0, 2.0, 2.0)),
        (np.zeros((9, 9, 2), np.uint8), (4.0, 4.0, 2.0, 2.0)),
        (np.zeros((9, 9, 1), np.uint8), (4.0, 4.0, 2.0, 2.0)),
        (np.zeros((0, 9, 3), np.uint8), (4.0, 4.0, 2.0, 2.0)),
        (np.zeros((9, 9, 3), np.uint8), (4.0, 4.0, 2.0)),
        (np.zeros((9, 9, 3), np.uint8), (40.0, 4.0, 2.0, 2.0)),
        (np.zeros((9, 9, 3), np.uint8), (4.0, np.nan, 2.0, 2.0)),
        (np.zeros((9, 9, 3), np.uint8), (4.0, 4.0, -2.0, 2.0)),
        (np.zeros((9, 9, 3), np.uint8), (4.0, 4.0, 2.0, 1.0)),
        (np.zeros((9, 9, 3), np.uint8), (4.0, 4.0, 2.0, np.inf)),
        (np.zeros((9, 9, 3), np.uint8), (4.0, 4.0, 1.2e308, 1.2e308)),
    ],
)
def test_a_sample_that_is_none_is_refused(
    tmp_path: Path, sample: npt.NDArray[np.generic], circle: tuple[float, ...]
) -> None:
    path, odds = tmp_path / "odd.npz", np.zeros(32768, np.float32)
    archive(path, matchset_color=np.int64(1), log_odds=odds, sample=sample, circle=np.array(circle))
    with pytest.raises(ValueError, match="not a color file"):
        ms.ColorModel.load(path)


def archive(path: Path, **arrays: object) -> Path:
    with path.open("wb") as file:
        np.savez_compressed(file, **arrays)  # type: ignore[arg-type]
    return path


def test_files_that_are_no_color(tmp_path: Path) -> None:
    text, cut = tmp_path / "text.npz", tmp_path / "cut.npz"
    text.write_text("hello")
    ms.ColorModel.pick(picture(), *CENTERS["green"]).save(cut)
    cut.write_bytes(cut.read_bytes()[:-200])
    odds, version = np.zeros(256, np.float32), np.int64(1)
    for path, words in (
        (tmp_path / "missing.npz", "no such color file"),
        (tmp_path, "not a color file"),
        (text, "not a color file"),
        (cut, "not a color file"),
        (archive(tmp_path / "other.npz", x=odds), "not a color file"),
        (archive(tmp_path / "objects.npz", matchset_color=version, log_odds=[None, {}]), "not a color file"),
        (archive(tmp_path / "words.npz", matchset_color=version, log_odds=np.array(["a"] * 256)), "color"),
        (archive(tmp_path / "newer.npz", matchset_color=np.int64(2), log_odds=odds), "has version 2"),
        (archive(tmp_path / "size.npz", matchset_color=version, log_odds=odds[1:]), "not a color file"),
    ):
        with pytest.raises(ValueError, match=words) as caught:
            ms.ColorModel.load(path)
        assert str(path) in str(caught.value)
        assert "\n" not in str(caught.value)


# misuse


@pytest.mark.parametrize(
    "region", [(0, 0, 0, 5), (5, 5, 5, -1), (-1, 0, 5, 5), (215, 0, 6, 5), (0, 176, 5, 5), (900, 900, 5, 5)]
)
def test_a_region_outside_the_picture(region: tuple[int, int, int, int]) -> None:
    with pytest.raises(ValueError, match=r"does not lie in the 220 x 180 picture") as caught:
        ms.ColorModel.learn(picture(), region)
    assert str(region) in str(caught.value)


@pytest.mark.parametrize(
    ("x", "y"), [(-0.6, 5.0), (219.5, 5.0), (5.0, -0.6), (5.0, 179.5), (np.nan, 5.0), (np.inf, 1.0)]
)
def test_a_click_outside_the_picture(x: float, y: float) -> None:
    with pytest.raises(ValueError, match=r"does not lie in the 220 x 180 picture") as caught:
        ms.ColorModel.pick(picture(), x, y)
    assert str(x) in str(caught.value)


@pytest.mark.parametrize(("x", "y"), [(-0.5, -0.5), (219.4, 179.4), (0.0, 179.0)])
def test_a_click_into_a_corner_is_in_the_picture(x: float, y: float) -> None:
    assert ms.ColorModel.pick(with_corner(x, y), x, y).channels == 3


def with_corner(x: float, y: float) -> Picture:
    image = picture()
    cv2.circle(image, (round(x), round(y)), 25, (20, 200, 220), cv2.FILLED)
    return image


@pytest.mark.parametrize("shape", [(60, 80, 3), (60, 80)])
def test_a_color_that_is_that_of_the_background(shape: tuple[int, ...]) -> None:
    flat = np.full(shape, 120, np.uint8)
    with pytest.raises(ValueError, match=r"region \(10, 10, 9, 9\): .*background"):
        ms.ColorModel.learn(flat, (10, 10, 9, 9))
    with pytest.raises(ValueError, match=r"pick \(10, 10\): .*background"):
        ms.ColorModel.pick(flat, 10, 10)


def test_a_region_of_everything_leaves_no_background() -> None:
    with pytest.raises(ValueError, match="no background is left"):
        ms.ColorModel.learn(picture(), (0, 0, 220, 180))


@pytest.mark.parametrize("shape", [(1, 1, 3), (3, 3), (2, 40, 3)])
def test_tiny_pictures_are_refused_in_words(shape: tuple[int, ...]) -> None:
    with pytest.raises(ValueError, match="background"):
        ms.ColorModel.pick(np.zeros(shape, np.uint8), 0, 0)
