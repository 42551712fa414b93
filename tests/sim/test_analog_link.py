import math
import zlib

import cv2
import numpy as np
import numpy.typing as npt
import pytest

from matchset.sim.analog_link import BAD, CLEAN, PRESETS, TYPICAL, AnalogLink, degrade, noise_gain, pole
from matchset.sim.line_filter import LineNoise, LineReceiver, send

PIXEL_TIME = 81e-9


def waves(frequency: float, width: int = 640) -> npt.NDArray[np.float32]:
    """Gray sine of a frequency in Hz along the lines."""
    x = np.arange(width)
    line = 128.0 + 60.0 * np.sin(2.0 * math.pi * frequency * PIXEL_TIME * 640 / width * x)
    return np.repeat(np.tile(line, (64, 1))[..., None], 3, axis=2).astype(np.float32)


def flat(color: tuple[float, float, float] = (128.0, 128.0, 128.0)) -> npt.NDArray[np.float32]:
    return np.full((480, 640, 3), color, np.float32)


def channels(image: npt.NDArray[np.uint8]) -> npt.NDArray[np.float64]:
    """Y, Cb, Cr."""
    blue, green, red = np.moveaxis(image.astype(float), 2, 0)
    luma = 0.114 * blue + 0.587 * green + 0.299 * red
    return np.stack((luma, 0.564 * (blue - luma), 0.713 * (red - luma)))


@pytest.mark.parametrize("bandwidth", [2e6, 3e6])
def test_luma_is_3_db_down_at_its_bandwidth_with_zero_phase(bandwidth: float) -> None:
    source = waves(bandwidth)
    image = degrade(source, AnalogLink(luma_bandwidth=bandwidth), 0)
    inner = slice(40, -40)
    x = np.arange(640)[inner]
    phase = np.exp(-2j * math.pi * bandwidth * PIXEL_TIME * x)
    before, after = (((p[5, inner, 1].astype(float) - 128.0) * phase).sum() for p in (source, image))
    assert 20.0 * math.log10(abs(after / before)) == pytest.approx(-3.01, abs=0.1)
    assert np.angle(after / before) == pytest.approx(0.0, abs=0.01)


def test_chroma_is_3_db_down_at_its_bandwidth_with_zero_phase_and_luma_untouched() -> None:
    bandwidth = 0.6e6
    x = np.arange(640)
    wave = 40.0 * np.sin(2.0 * math.pi * bandwidth * PIXEL_TIME * x)
    luma_free = np.stack((1.773 * wave, -0.3444 * wave, 0.0 * wave), axis=1)
    source = (128.0 + np.tile(luma_free, (64, 1, 1))).astype(np.float32)
    image = degrade(source, AnalogLink(chroma_bandwidth=bandwidth), 0)
    inner = slice(60, -60)
    phase = np.exp(-2j * math.pi * bandwidth * PIXEL_TIME * x[inner])
    after = (channels(image)[1, 5, inner] * phase).sum()
    before = (wave[inner] * phase).sum()
    assert 20.0 * math.log10(abs(after / before)) == pytest.approx(-3.01, abs=0.15)
    assert np.angle(after / before) == pytest.approx(0.0, abs=0.02)
    assert channels(image)[0].std() < 0.6


def test_the_filter_keeps_an_edge_in_its_place() -> None:
    source = flat((40.0, 40.0, 40.0))[:64]
    source[:, 300:] = 200.0
    line = degrade(source, AnalogLink(luma_bandwidth=2e6), 0)[10, :, 1].astype(float)
    assert np.interp(120.0, line[290:310], np.arange(290, 310)) == pytest.approx(299.5, abs=0.02)


def test_chroma_averaging_moves_nothing_up_or_down() -> None:
    rows = np.zeros((480, 640, 3), np.float32)
    rows[:] = (90.0, 130.0, 90.0)
    rows[200:240] = (220.0, 90.0, 60.0)
    image = degrade(rows, AnalogLink(interlaced=True, chroma_lines=True), 0)
    blue = channels(image)[1, :, 320]
    weight = blue - blue[0]
    assert (weight * np.arange(480)).sum() / weight.sum() == pytest.approx(219.5, abs=0.05)


@pytest.mark.parametrize(("pal", "luma", "chroma"), [(TYPICAL, 6.0, 8.0), (BAD, 15.0, 20.0)])
def test_noise_in_the_picture_has_the_stated_deviation(pal: AnalogLink, luma: float, chroma: float) -> None:
    quiet = AnalogLink(**{f: getattr(pal, f) for f in pal.__struct_fields__} | {"lost_lines": 0.0, "line_jitter": 0.0})
    y, cb, cr = channels(degrade(flat(), quiet, 3))
    assert y.std() == pytest.approx(luma, rel=0.05)
    assert cb.std() == pytest.approx(chroma, rel=0.06)
    assert cr.std() == pytest.approx(chroma, rel=0.06)
    assert abs(y.mean() - 128.0) < 0.3


def test_noise_is_as_coarse_as_the_band_is_narrow() -> None:
    _, cb, _ = channels(degrade(flat(), TYPICAL, 3))
    neighbors = np.corrcoef(cb[:, :-1].ravel(), cb[:, 1:].ravel())[0, 1]
    assert neighbors > 0.8


def test_clean_is_a_little_blur_and_white_noise() -> None:
    image = degrade(flat(), CLEAN, 1).astype(float)
    assert image.std() == pytest.approx(2.0, rel=0.03)
    assert abs(np.corrcoef(image[:, :-1, 0].ravel(), image[:, 1:, 0].ravel())[0, 1]) < 0.02
    assert abs(np.corrcoef(image[..., 0].ravel(), image[..., 1].ravel())[0, 1]) < 0.02
    spot = flat((0.0, 0.0, 0.0))
    spot[100, 100] = 255.0
    expected = cv2.GaussianBlur(spot, (9, 9), 0.5)[100, 100, 0]
    assert degrade(spot, AnalogLink(blur=0.5), 0)[100, 100, 0] == pytest.approx(expected, abs=1.0)


def test_lines_jitter_by_a_normal_deviate() -> None:
    source = flat((40.0, 40.0, 40.0))
    source[:, 300:] = 200.0
    source = np.asarray(cv2.GaussianBlur(source, (0, 0), 2.0), np.float32)
    image = degrade(source, AnalogLink(line_jitter=1.0), 5)[..., 1].astype(float)
    places = [np.interp(120.0, line[285:315], np.arange(285, 315)) for line in image]
    assert np.std(places) == pytest.approx(1.0, rel=0.12)
    assert np.mean(places) == pytest.approx(299.5, abs=0.15)


def test_lost_lines_are_noise_without_color() -> None:
    image = degrade(flat((200.0, 60.0, 20.0)), AnalogLink(lost_lines=0.2), 2).astype(float)
    lost = np.ptp(image[..., 0], axis=1) > 20.0
    assert lost.mean() == pytest.approx(0.2, abs=0.06)
    assert np.ptp(image[lost], axis=2).max() == 0.0
    assert image[lost].std() > 50.0


def test_gain_saturates_at_white() -> None:
    image = degrade(flat((200.0, 100.0, 50.0)), AnalogLink(), 0, (1.5, 1.5, 0.5))
    assert image[0, 0].tolist() == [255, 150, 25]


def test_the_same_seed_gives_the_same_bytes() -> None:
    for pal in PRESETS.values():
        first, again, other = (degrade(flat(), pal, seed) for seed in (7, 7, 8))
        np.testing.assert_array_equal(first, again)
        assert (first != other).any()


def test_the_filter_follows_from_its_bandwidth() -> None:
    assert pole(0.0, 640) == 0.0
    assert pole(20e6, 640) == 0.0
    assert 0.0 < pole(3e6, 640) < pole(3e6, 3840) < 1.0
    assert noise_gain(0.0) == 1.0
    p = pole(0.6e6, 640)
    response = (1.0 - p) / (1.0 + p) * p ** np.abs(np.arange(-500, 501))
    assert noise_gain(p) == pytest.approx(math.sqrt((response**2).sum()))


def test_misuse() -> None:
    with pytest.raises(ValueError, match="-1"):
        AnalogLink(luma_noise=-1.0)
    with pytest.raises(ValueError, match=r"1\.5"):
        AnalogLink(lost_lines=1.5)
    with pytest.raises(ValueError, match="int16"):
        degrade(np.zeros((4, 4, 3), np.int16), CLEAN, 0)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="sensor_noise"):
        degrade(flat(), AnalogLink(sensor_noise=1.0, luma_noise=1.0), 0)


def bars(height: int, width: int) -> npt.NDArray[np.uint8]:
    """Colors that change along and across the lines; B, G, R and a byte that is not looked at."""
    y, x = np.indices((height, width))
    return np.stack((5 * x + y, 3 * y, 255 - 2 * x, 7 * x), axis=2).astype(np.uint8)


@pytest.mark.parametrize("name", PRESETS)
@pytest.mark.parametrize("size", [(480, 640), (241, 322), (33, 64), (3, 5)])
def test_all_kinds_of_pictures_give_the_same_bytes(name: str, size: tuple[int, int]) -> None:
    words = bars(*size)
    image = degrade(words, PRESETS[name], 4, gain=(1.0, 0.9, 1.1))
    colors = np.ascontiguousarray(words[..., :3])
    np.testing.assert_array_equal(image, degrade(colors, PRESETS[name], 4, gain=(1.0, 0.9, 1.1)))
    np.testing.assert_array_equal(image, degrade(colors.astype(np.float32), PRESETS[name], 4, gain=(1.0, 0.9, 1.1)))


@pytest.mark.parametrize(("name", "checksum"), [("typical", 0x415BF9A5), ("bad", 0x520C3BC5)])
def test_a_link_gives_the_bytes_that_it_always_gave(name: str, checksum: int) -> None:
    """Scores of flights are kept: a faster link may not be another one."""
    assert zlib.crc32(degrade(bars(200, 320)[..., :3].copy(), PRESETS[name], 5).tobytes()) == checksum


def slow_bits(counter: npt.NDArray[np.uint32]) -> npt.NDArray[np.uint32]:
    """The 32 random bits of each counter: `lowbias32`."""
    z = counter ^ (counter >> np.uint32(16))
    z = z * np.uint32(0x7FEB352D)
    z = z ^ (z >> np.uint32(15))
    z = z * np.uint32(0x846CA68B)
    return np.asarray(z ^ (z >> np.uint32(16)), np.uint32)


def slow_noise(first: int, shape: tuple[int, ...]) -> npt.NDArray[np.float32]:
    """Sum of the four bytes of each hash, of variance 1; counted through in the order of the array."""
    bits = slow_bits((first + np.arange(math.prod(shape))).astype(np.uint32)).reshape(shape)
    total = sum((bits >> np.uint32(8 * k) & np.uint32(255)).astype(np.int32) for k in range(4))
    return np.asarray(total - 510, np.float32) * np.float32(1.0 / math.sqrt(4.0 * (256.0**2 - 1.0) / 12.0))


def slow_send(
    picture: npt.NDArray[np.float32], gain: npt.NDArray[np.float64], shift: npt.NDArray[np.float64], noise: LineNoise
) -> npt.NDArray[np.float32]:
    """Y, Cb and Cr, (h, 3, w), of a picture with shifted lines, and noise."""
    height, width = picture.shape[:2]
    whole = np.floor(-shift).astype(np.int64)
    part = (-shift - whole).astype(np.float32)[:, None, None]
    columns = np.clip(np.arange(width + 1) + whole[:, None], 0, width - 1)
    line = picture[np.arange(height)[:, None], columns]
    moved = np.minimum(gain.astype(np.float32) * (line[:, :-1] + part * (line[:, 1:] - line[:, :-1])), np.float32(255))
    blue, green, red = moved.transpose(2, 0, 1)
    gray = np.float32(0.114) * blue + np.float32(0.587) * green + np.float32(0.299) * red
    planes = np.stack((gray, np.float32(0.564) * (blue - gray), np.float32(0.713) * (red - gray)), axis=1)
    sigma = np.array((noise.luma, noise.chroma, noise.chroma), np.float32)[:, None]
    return np.asarray(planes + sigma * slow_noise(int(noise.counter), planes.shape), np.float32)


def slow_receive(planes: npt.NDArray[np.float32], receiver: LineReceiver) -> npt.NDArray[np.uint8]:
    """Average chroma over lines, filter forward and back, and convert to bytes of B, G and R."""
    height, _, width = planes.shape
    y, n = np.arange(height), receiver.neighbor
    up, down = planes[np.where(y >= n, y - n, y)], planes[np.where(y + n < height, y + n, y)]
    planes[:, 1:] = (np.float32(0.5) * planes + np.float32(0.25) * (up + down))[:, 1:]
    pole = np.array((receiver.luma_pole, receiver.chroma_pole, receiver.chroma_pole), np.float32)
    for x in range(1, width):
        planes[..., x] += pole * (planes[..., x - 1] - planes[..., x])
    for x in range(width - 2, -1, -1):
        planes[..., x] += pole * (planes[..., x + 1] - planes[..., x])
    luma, cb, cr = planes.transpose(1, 0, 2)
    green = luma - np.float32(0.3444) * cb - np.float32(0.7144) * cr
    bgr = np.stack((luma + np.float32(1.773) * cb, green, luma + np.float32(1.4025) * cr), axis=2)
    return np.clip(bgr + np.float32(0.5), 0.0, 255.0).astype(np.uint8)


@pytest.mark.parametrize("size", [(1, 1), (3, 5), (33, 64), (101, 66)])
@pytest.mark.parametrize("neighbor", [0, 1, 2])
def test_lines_are_sent_as_the_slow_way_sends_them(size: tuple[int, int], neighbor: int) -> None:
    rng = np.random.default_rng(neighbor)
    words = rng.integers(0, 2**32, size, dtype=np.uint32)
    gain, shift = np.array((1.1, 0.9, 1.7)), rng.normal(0.0, 20.0, size[0])
    noise = LineNoise(6.0, 9.0, np.uint32(2**32 - 50))
    receiver = LineReceiver(0.4, 0.2, neighbor, np.zeros(size[0], np.bool_))
    out = np.empty((*size, 3), np.uint8)
    send(words, gain, shift, noise, receiver, out)
    picture = words.view(np.uint8).reshape(*size, 4)[..., :3].astype(np.float32)
    np.testing.assert_array_equal(out, slow_receive(slow_send(picture, gain, shift, noise), receiver))
