import sys

import cv2
import numpy as np
import numpy.typing as npt
import pytest

from matchset.sim.clips.clip import Clip
from matchset.sim.digital_camera.codec import Codec

SMALL = {"width": 160, "height": 120, "radii": (8.0, 30.0), "preset": "clean"}
H264, MJPEG = Codec(name="h264", kbps=60.0), Codec(kbps=900.0)
CODECS = [pytest.param(MJPEG, id="mjpeg"), pytest.param(H264, id="h264")]


def small(**changes: object) -> Clip:
    return Clip(**(SMALL | changes))  # type: ignore[arg-type]


def needs(codec: Codec) -> None:
    if codec.name == "h264":
        pytest.importorskip("av", reason="PyAV is not installed")


@pytest.mark.parametrize("codec", CODECS)
def test_size_count_and_truth_stay_and_the_pictures_change(codec: Codec) -> None:
    needs(codec)
    raw, coded, again = (list(small(frames=8, seed=2, codec=c)) for c in (None, codec, codec))
    assert len(coded) == 8
    for (frame, truth), (other, told), (same, _) in zip(raw, coded, again, strict=True):
        assert (other.index, other.time) == (frame.index, frame.time)
        assert told == truth
        assert other.image.shape == frame.image.shape
        assert other.image.dtype == np.uint8
        assert (other.image != frame.image).any()
        assert np.abs(other.image.astype(int) - frame.image).mean() < 20.0
        np.testing.assert_array_equal(other.image, same.image)


@pytest.mark.parametrize("codec", CODECS)
def test_more_bits_are_more_exact(codec: Codec) -> None:
    needs(codec)
    raw = [frame.image.astype(int) for frame, _ in small(frames=6)]
    errors = []
    for factor in (0.7, 2.0, 8.0):
        rate = Codec(name=codec.name, kbps=factor * codec.kbps)
        coded = [frame.image for frame, _ in small(frames=6, codec=rate)]
        errors.append(float(np.mean([np.abs(a - b).mean() for a, b in zip(raw, coded, strict=True)])))
    assert errors[0] > errors[1] > errors[2]


def test_what_rests_gets_better_from_frame_to_frame_in_h264_only() -> None:
    needs(H264)
    image = next(iter(small(frames=1, preset=None)))[0].image
    errors = {}
    for codec in (H264, MJPEG):
        coder = codec.start(160, 120, 30.0)
        errors[codec.name] = [float(np.abs(coder(image).astype(int) - image).mean()) for _ in range(20)]
    assert errors["h264"][-1] < 0.8 * errors["h264"][0]
    assert len(set(errors["mjpeg"])) == 1


@pytest.mark.parametrize("codec", [Codec(kbps=6000.0), Codec(name="h264", kbps=4000.0)])
def test_chroma_has_half_the_resolution(codec: Codec) -> None:
    needs(codec)
    image = np.zeros((64, 64, 3), np.uint8)
    image[:, ::2] = (0, 0, 200)
    image[:, 1::2] = (200, 0, 0)  # red and blue columns: chroma that no pair of columns can keep
    coded = codec.start(64, 64, 30.0)(image).astype(int)
    assert np.ptp(coded[16:48, 16:48, 0].mean(axis=0)) < 100


def test_motion_jpeg_takes_the_best_quality_that_fits() -> None:
    image = next(iter(small(frames=1)))[0].image
    coded = Codec(kbps=900.0).start(160, 120, 30.0)(image)
    sampling = [cv2.IMWRITE_JPEG_SAMPLING_FACTOR, cv2.IMWRITE_JPEG_SAMPLING_FACTOR_420]
    packed = [cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, q, *sampling])[1] for q in range(1, 101)]
    best = [each for each in packed if len(each) <= 900_000 / 8 / 30][-1]
    np.testing.assert_array_equal(coded, cv2.imdecode(best, cv2.IMREAD_COLOR))


def decoded_alone(image: npt.NDArray[np.uint8]) -> npt.NDArray[np.uint8]:
    return Codec(name="h264", kbps=60.0).start(160, 120, 30.0)(image)


def test_a_frame_of_h264_depends_on_those_before_it() -> None:
    needs(H264)
    frames = [frame for frame, _ in small(frames=5, seed=2)]
    coded = [frame for frame, _ in small(frames=5, seed=2, codec=H264)]
    np.testing.assert_array_equal(coded[0].image, decoded_alone(frames[0].image))
    assert (coded[4].image != decoded_alone(frames[4].image)).any()


def test_without_pyav_one_line_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "av", None)
    with pytest.raises(ValueError, match=r"pip install 'av"):
        H264.start(160, 120, 30.0)


@pytest.mark.parametrize(
    ("changes", "text"), [({"name": "vp9"}, "vp9"), ({"kbps": 1.0}, "1.0"), ({"keyframes": 0}, "got 0")]
)
def test_misuse_of_a_codec(changes: dict[str, object], text: str) -> None:
    with pytest.raises(ValueError, match=text):
        Codec(**changes)  # type: ignore[arg-type]


def test_h264_refuses_an_odd_size() -> None:
    with pytest.raises(ValueError, match="161 x 120"):
        H264.start(161, 120, 30.0)
