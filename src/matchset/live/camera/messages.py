"""What a page says of the camera."""

from typing import Annotated, Literal

import msgspec

from matchset.live.wire.messages import Name, Number, PageMessage

Corners = Annotated[int, msgspec.Meta(ge=3, le=100)]
Side = Annotated[float, msgspec.Meta(gt=0.0, le=10.0)]
Pixels = Annotated[int, msgspec.Meta(ge=16, le=16384)]
Value = Annotated[float, msgspec.Meta(ge=-1e6, le=1e6)]
Setting = Literal["exposure", "gain", "white_balance", "fps"]
Meters = Annotated[float, msgspec.Meta(gt=0.0, le=1000.0)]


class UseCamera(PageMessage, frozen=True, tag="use_camera"):
    """Use the camera file of this key in the menu."""

    key: Name


class LookForCameraFiles(PageMessage, frozen=True, tag="look_for_camera_files"):
    """Look again which camera files there are."""


class CalibrateBoard(PageMessage, frozen=True, tag="calibrate_board"):
    """Begin to look for a board: its inner corners, the side of a square in m, that of a marker if it has some."""

    columns: Corners
    rows: Corners
    square: Side
    marker: Side | None = None
    dictionary: Name = "5X5_100"


class EndBoard(PageMessage, frozen=True, tag="end_board"):
    """Calibrate with the views so far; or, where `use` is false, forget them."""

    use: bool = True


class BallAt(PageMessage, frozen=True, tag="ball_at"):
    """A target of known diameter is held still; its nearest point is at this distance from the lens, m."""

    target: Number
    meters: Meters


CameraWish = UseCamera | LookForCameraFiles | CalibrateBoard | EndBoard | BallAt
MESSAGES: tuple[type[PageMessage], ...] = (UseCamera, LookForCameraFiles, CalibrateBoard, EndBoard, BallAt)


class SetCameraSetting(PageMessage, frozen=True, tag="set_camera"):
    """Ask the camera for a setting, in its driver's unit; None: what the camera chooses."""

    name: Setting
    value: Value | None


class SetCameraSize(PageMessage, frozen=True, tag="set_camera_size"):
    """Ask the camera for pictures of a size, px."""

    width: Pixels
    height: Pixels


SettingWish = SetCameraSetting | SetCameraSize
SETTINGS: tuple[type[PageMessage], ...] = (SetCameraSetting, SetCameraSize)
