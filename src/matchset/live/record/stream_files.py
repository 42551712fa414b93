"""The files of one stream's recording: tables, bag, video and camera file (`StreamFiles`)."""

from importlib.util import find_spec
from pathlib import Path
from typing import Any

import cv2
import msgspec
import numpy as np

from matchset.app.disk import SpaceParameters
from matchset.app.films.video_writer import FilmWriter, FilmWriterParameters, quick_ending
from matchset.camera.camera_model import CameraModel
from matchset.image.frame import Frame
from matchset.live.feed import StreamPicture
from matchset.live.record.bag import BagWriter
from matchset.live.record.target_tables import TargetTables
from matchset.live.wire.state import State
from matchset.media.closing import Closing, close_all
from matchset.numeric.arguments import require_within


class FileParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How the files are packed.

    Parameters
    ----------
    bag_quality : int
        Of the JPEGs in the bag, 1 ... 100. More: larger files. Chosen by: tracked again, a ball is found as exactly as
        in the camera's pictures, decision 095.
    fps : float
        Frames per second of the video where the source tells none and none were counted yet. Chosen by hand: that of
        most cameras.
    agreement : float
        By which share the counted rate of a camera may differ from the one it tells, so that the latter is written.
        Chosen by hand: a count over a second is not surer.
    """

    bag_quality: int = 90
    fps: float = 30.0
    agreement: float = 0.1

    def __post_init__(self) -> None:
        require_within(self, {"bag_quality": (1, 100)})

    def rate(self, state: State) -> float:
        """Return the frames per second of a video that begins with a picture."""
        told, counted = state.camera_fps, state.fps
        if told and (not state.live or not counted or abs(counted - told) <= self.agreement * told):
            return told
        return counted or self.fps


class StreamFiles(Closing):
    """Writes what is seen in a stream; a file begins when there is something for it.

    Parameters
    ----------
    folder : Path
        Made if there is none.
    number : int
        Of the stream, from 0.
    parameters : FileParameters
    space : SpaceParameters
        How much of the disk the video leaves free.

    Attributes
    ----------
    count : int
        Pictures so far; a row's `frame` is the number of its picture in the video, from 0.
    computing : dict of str to float
        What a picture took since the source was opened, see `State.computing`; empty where nobody knows.
    """

    def __init__(self, folder: Path, number: int, parameters: FileParameters, space: SpaceParameters) -> None:
        self._folder, self._namespace, self._parameters = folder, f"/camera_{number + 1}", parameters
        self._film_parameters = FilmWriterParameters(space=space)
        self._tables = TargetTables(folder)
        self._bag: BagWriter | None = None
        self._film: FilmWriter | None = None
        self._cameras: list[CameraModel] = []
        self.count, self.computing = 0, dict[str, float]()

    @property
    def facts(self) -> dict[str, Any]:
        """What `recording.json` says of the stream."""
        return {
            "targets": [dict(target) for target in self._tables.targets],
            "cameras": [self._camera_name(number) for number in range(len(self._cameras))],
        }

    def write(self, seen: StreamPicture) -> None:
        """Append a picture with what was found in it.

        Raises
        ------
        OSError
            If it does not fit on the disk.
        ValueError
            If its size is not that of the pictures before.
        """
        frame = seen.frame
        if frame is None:
            return
        if self._film is None:
            self._begin(frame, seen.state)
        self._keep_camera(seen.camera)
        self._tables.write(self.count, frame, seen)
        if self._bag is not None:
            self._bag.write(self.count, frame, seen)
        self._write_picture(frame)
        self.count, self.computing = self.count + 1, seen.state.computing

    def close(self) -> None:
        """Close the files; the video last, which takes longest."""
        films = [] if self._film is None else [self._film.close]
        bags = [] if self._bag is None else [self._bag.close]
        close_all(self._tables.close, *bags, *films)

    def _begin(self, frame: Frame, state: State) -> None:
        """Begin bag and video; without the package mcap there is no bag."""
        self._folder.mkdir(exist_ok=True)
        if find_spec("mcap") is not None:
            self._bag = BagWriter(self._folder / "recording.mcap", self._namespace, self._parameters.bag_quality)
        height, width = frame.image.shape[:2]
        path = self._folder / f"raw{quick_ending()}"
        self._film = FilmWriter(path, self._parameters.rate(state), (width, height), state.live, self._film_parameters)

    def _write_picture(self, frame: Frame) -> None:
        film = self._film
        if film is None:
            return
        if film.failure is not None:
            raise film.failure
        gray = frame.image.ndim == 2
        film.write(cv2.cvtColor(frame.image, cv2.COLOR_GRAY2BGR).astype(np.uint8) if gray else frame.image)

    def _keep_camera(self, camera: CameraModel | None) -> None:
        """Write the camera file, if the camera is another than before."""
        if camera is None or (self._cameras and self._cameras[-1] is camera):
            return
        camera.save(self._folder / self._camera_name(len(self._cameras)))
        self._cameras.append(camera)

    def _camera_name(self, number: int) -> str:
        return "camera.toml" if number == 0 else f"camera_{number + 1}.toml"
