"""How hard films are packed: `PackingParameters`."""

import msgspec


class PackingParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How a film is packed.

    Parameters
    ----------
    piece : float
        Length of the pieces of a file, s: what a killed program loses beside the queue. Shorter ones cost some 100
        bytes each. Chosen by: `python -m benchmarks.lost.killed`, decision 092.
    effort : int
        libvpx's "cpu-used" in real time, 0 ... 8: more is faster and a little larger. Chosen by: the same.
    vp8 : int
        Quantizer of VP8, 0 ... 63: less is better and larger. Chosen by: error as OpenCV's film, the same.
    h264 : int
        Quality of H.264 (libx264's "crf"), 0 ... 51: less is better and larger. Chosen by: error as that of VP8 on the
        noise of an analog link, decision 093.
    preset : str
        libx264's preset: slower ones give smaller files. Chosen by: the same; "superfast" takes twice the time for
        files smaller by a fifth.
    vp8_rate : int
        Most bits per second of VP8. Chosen by: the same, with the noise of an analog link.
    h264_small : int
        Quality of H.264 of a small film. More smooths more. Chosen by: a flight of 20 s below 5 MB,
        docs/log/files.md#small-films.
    h264_small_rate : int
        Most bits per second of H.264 of a small film, over a second: a bad link's noise is smoothed more. Chosen by:
        less than 1 MB a second.
    vp8_small : int
        Quantizer of VP8 of a small film. Chosen by: the same.
    vp8_small_rate : int
        Most bits per second of VP8 of a small film. Chosen by: the same.
    jpeg : int
        Quantizer of Motion JPEG, 2 ... 31. Chosen by: error as OpenCV's film, the same.
    jpeg_small : int
        The same of a small film. Chosen by: docs/decisions/139-files-of-a-sensible-size.md.
    mpeg4_small_rate : int
        Bits per second of a small film packed as MPEG-4, or as H.264 by OpenH264. Chosen by: the same.
    """

    piece: float = 0.1
    effort: int = 8
    vp8: int = 10
    h264: int = 20
    preset: str = "ultrafast"
    vp8_rate: int = 16_000_000
    h264_small: int = 31
    h264_small_rate: int = 7_000_000
    vp8_small: int = 30
    vp8_small_rate: int = 1_900_000
    jpeg: int = 2
    jpeg_small: int = 12
    mpeg4_small_rate: int = 4_000_000

    def options(self, codec: str, small: bool = False) -> dict[str, str]:
        """Options of FFmpeg's encoder of a codec."""
        if codec == "mjpeg":
            quantizer = self.jpeg_small if small else self.jpeg
            return {"qmin": str(quantizer), "qmax": str(quantizer)}
        if codec in ("mpeg4", "libopenh264"):
            return {"b": str(self.mpeg4_small_rate)} if small else {}
        if codec == "libx264":
            quick = {"preset": self.preset, "tune": "zerolatency"}
            most = str(self.h264_small_rate)
            bounded = {"crf": str(self.h264_small), "maxrate": most, "bufsize": most}
            return quick | (bounded if small else {"crf": str(self.h264)})
        if codec != "libvpx":
            return {}
        fast = {"deadline": "realtime", "cpu-used": str(self.effort), "lag-in-frames": "0"}
        if small:
            return fast | {"crf": str(self.vp8_small), "b": str(self.vp8_small_rate)}
        return fast | {"crf": str(self.vp8), "b": str(self.vp8_rate)}

    def words(self, codec: str, small: bool = False) -> list[str]:
        """Options of a codec as words of the command line of `ffmpeg`."""
        return [word for name, value in self.options(codec, small).items() for word in (f"-{name}", value)]


PACKING = PackingParameters()
