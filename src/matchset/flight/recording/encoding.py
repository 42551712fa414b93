"""Steps and pictures to messages and back, to the last bit: also infinities and minus zero.

Arrays become lists. Two steps are the same if and only if their bytes are.
"""

from typing import Any, TypeVar

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.flight.chain.chain_step import ChainStep
from matchset.flight.chain.pilot import PilotStep
from matchset.flight.recording.messages import (
    FORMAT,
    OLDER_NAMES,
    WITHOUT_GAINS,
    ColorsMessage,
    Outcome,
    Picture,
    SightMessage,
    StepMessage,
    Triple,
    TruthMessage,
)
from matchset.image.color import ColorModel
from matchset.image.frame import Frame, Rows
from matchset.localization.markers.ball_colors import BallColors
from matchset.media.bags.packed_fields import NANO
from matchset.media.bags.ros_image import COMPRESSED_IMAGE, read_picture
from matchset.media.picture import decode_picture
from matchset.sim.vehicle import VehiclePose

M = TypeVar("M")

OLDER = {"control": "answer", "safety": "memory", "rotation_matrix": "turn"}
"""What was called otherwise in an outcome up to format 3."""


def _plain(value: Any) -> Any:
    """Convert arrays and numbers of NumPy, which msgpack does not know."""
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    raise TypeError(f"cannot record a {type(value).__name__}")


_ENCODER = msgspec.msgpack.Encoder(enc_hook=_plain)


def encode(message: Any) -> bytes:
    """Encode a message as msgpack."""
    return _ENCODER.encode(message)


def decode(data: bytes, kind: type[M]) -> M:
    """Decode a message.

    Raises
    ------
    ValueError
        If it is not of this kind.
    """
    try:
        return msgspec.msgpack.decode(data, type=kind)
    except (msgspec.DecodeError, ValueError, RecursionError) as error:
        raise ValueError(f"a message is no {kind.__name__}: {error}") from None


def outcome_of(step: PilotStep, form: int = FORMAT) -> bytes:
    """Encode everything of a step that a replay must reproduce: all but the picture and the computing times.

    Parameters
    ----------
    step : PilotStep
    form : int
        Format of the recording with which it is compared.
    """
    control = step.control[:-1] if form == WITHOUT_GAINS and step.control is not None else step.control
    outcome = encode(
        Outcome(
            ball=step.ball,
            markers=step.markers,
            pose=step.pose,
            control=control,
            safety=step.safety,
            command=step.command,
            age=step.age,
        )
    )
    return encode(_with_older_names(msgspec.msgpack.decode(outcome))) if form <= OLDER_NAMES else outcome


def _with_older_names(value: Any) -> Any:
    """Return an outcome with the names that it had up to format 3, which had no `pixel_aspect`; all else as it is."""
    if isinstance(value, dict):
        named = {key: each for key, each in value.items() if key != "pixel_aspect"}
        return {OLDER.get(key, key): _with_older_names(each) for key, each in named.items()}
    return [_with_older_names(each) for each in value] if isinstance(value, list) else value


def step_message(index: int, step: PilotStep, armed: bool) -> StepMessage:
    """Make the message of a step."""
    return StepMessage(
        tick=index,
        armed=armed,
        frame=None if step.frame is None else step.frame.index,
        taken=None if step.frame is None else step.frame.time,
        now=step.now,
        command=step.command,
        spent=step.stage_times,
        outcome=msgspec.Raw(outcome_of(step)),
        stopped=step.stopped,
        landing=step.landing,
        rows="all" if step.frame is None else step.frame.rows,
    )


def colors_message(colors: BallColors) -> ColorsMessage:
    """Make the message of what a follower looks for."""
    return ColorsMessage(*(model.log_odds.astype("<f4").tobytes() for model in colors))


def colors_of(message: ColorsMessage) -> BallColors:
    """Make what a follower looks for of its message.

    Raises
    ------
    ValueError
        If it holds no color models.
    """
    tables = message.ball, message.marker
    return BallColors(*(ColorModel(np.frombuffer(each[: len(each) // 4 * 4], "<f4")) for each in tables))


def truth_message(chain_step: ChainStep) -> TruthMessage:
    """Make the message of the simulator's truth at a step."""
    return TruthMessage(
        index=chain_step.index,
        time=chain_step.time,
        truth=tuple(_sight_message(vehicle) for vehicle in chain_step.truth),
        shown=tuple(_sight_message(vehicle) for vehicle in chain_step.truth_at_exposure),
        places=tuple(_triple(place) for place in chain_step.true_positions),
        inside=chain_step.in_view,
        crashes=chain_step.crashes,
    )


def _sight_message(vehicle: VehiclePose) -> SightMessage:
    first, second, third = (_triple(row) for row in vehicle.rotation)
    return SightMessage(_triple(vehicle.position), (first, second, third), _triple(vehicle.ball))


def _triple(values: npt.NDArray[np.float64]) -> Triple:
    x, y, z = values.tolist()
    return x, y, z


def vehicle_pose(message: SightMessage) -> VehiclePose:
    """Make a `VehiclePose` of its message."""
    return VehiclePose(np.array(message.place), np.array(message.turn), np.array(message.ball))


def to_png(image: npt.NDArray[np.uint8]) -> bytes:
    """Compress a picture without loss, quickly: more effort does not make noise smaller (decision 060)."""
    parameters = [cv2.IMWRITE_PNG_COMPRESSION, 1, cv2.IMWRITE_PNG_STRATEGY, cv2.IMWRITE_PNG_STRATEGY_HUFFMAN_ONLY]
    return cv2.imencode(".png", image, parameters)[1].tobytes()


def frame_of(message: Picture) -> Frame:
    """Make a frame of its message.

    Raises
    ------
    ValueError
        If the PNG does not decode.
    """
    image = decode_picture(message.png, cv2.IMREAD_UNCHANGED)
    if image is None:
        raise ValueError(f"the picture of frame {message.index} does not decode")
    return Frame(np.asarray(image, np.uint8), message.time, message.index)


def frame_of_image(data: bytes, index: int, taken: float, rows: Rows = "all") -> Frame:
    """Make a frame of a message sensor_msgs/CompressedImage.

    Parameters
    ----------
    data : bytes
    index : int
        Index of the picture in its step.
    taken : float
        When it was taken, s.
    rows : str
        Which rows were taken then.

    Raises
    ------
    ValueError
        If the message is of another time, or its picture does not decode.
    """
    stamp, _, image, *_ = read_picture(data, COMPRESSED_IMAGE, ros1=False)
    if stamp != max(round(NANO * taken), 0):
        raise ValueError(f"the picture of frame {index} is missing: there is one of {stamp / NANO} s, not {taken} s")
    if image is None:
        raise ValueError(f"the picture of frame {index} does not decode")
    return Frame(image, taken, index, rows=rows)
