"""A simulated world: vehicles that fly in a room, and the pictures of their cameras, from a seed.

Public names are those of `__all__`, loaded when they are first used: ``import matchset as ms; ms.sim.World``; the page
docs/simulation.md shows each. Read `vehicle` (what a vehicle is like, with ``vehicle.toml``), `quadrotor` (its
equations of motion) and `rope` first, then `world` (a chain of vehicles; `chain_motion` holds its kernels). `cameras`
draws what they see: `vehicle_camera` one field of one camera with `airframe` for the vehicles, `analog_link` (its
kernels: `line_filter`) what a transmitter makes of it. `toml_settings` reads settings. Folders: `rendering` (how things
are drawn), `scene` (the room), `clips` (sequences of frames with their truth), `digital_camera` (phones and
codecs), `conditions` (gusts, shade, errors of outlines), `on_board` (what a vehicle does by itself).
"""

from matchset.numeric.imports import lazy_names

TYPE_CHECKING = False  # as in `typing`, which takes longer to import than this package
if TYPE_CHECKING:
    from matchset.control.command import Command
    from matchset.control.follower import RelativeSetpoint
    from matchset.sim.analog_link import AnalogLink, degrade
    from matchset.sim.cameras import WorldCameras
    from matchset.sim.clips.ball_flight_clip import BallFlightClip
    from matchset.sim.clips.balloon import Balloon
    from matchset.sim.clips.clip import Clip
    from matchset.sim.clips.multi_ball_clip import MultiBallClip
    from matchset.sim.clips.shape_clip import ShapeClip
    from matchset.sim.clips.truth import ClipTruth
    from matchset.sim.digital_camera.codec import Codec
    from matchset.sim.digital_camera.control_steps import ControlSteps
    from matchset.sim.digital_camera.digital_camera import DigitalCamera
    from matchset.sim.rendering.renderer import Light
    from matchset.sim.rope import RopeParameters
    from matchset.sim.scene.scene import Scene
    from matchset.sim.vehicle import VehicleParameters, VehiclePose, toy
    from matchset.sim.world import RATE, ChainParameters, World, camera_position, relative_position

__all__ = [
    "RATE",
    "AnalogLink",
    "BallFlightClip",
    "Balloon",
    "ChainParameters",
    "Clip",
    "ClipTruth",
    "Codec",
    "Command",
    "ControlSteps",
    "DigitalCamera",
    "Light",
    "MultiBallClip",
    "RelativeSetpoint",
    "RopeParameters",
    "Scene",
    "ShapeClip",
    "VehicleParameters",
    "VehiclePose",
    "World",
    "WorldCameras",
    "camera_position",
    "degrade",
    "relative_position",
    "toy",
]

# The same as the imports above; a test compares them.
_MODULES = {
    "RATE": "matchset.sim.world",
    "AnalogLink": "matchset.sim.analog_link",
    "BallFlightClip": "matchset.sim.clips.ball_flight_clip",
    "Balloon": "matchset.sim.clips.balloon",
    "ChainParameters": "matchset.sim.world",
    "Clip": "matchset.sim.clips.clip",
    "ClipTruth": "matchset.sim.clips.truth",
    "Codec": "matchset.sim.digital_camera.codec",
    "Command": "matchset.control.command",
    "ControlSteps": "matchset.sim.digital_camera.control_steps",
    "DigitalCamera": "matchset.sim.digital_camera.digital_camera",
    "Light": "matchset.sim.rendering.renderer",
    "MultiBallClip": "matchset.sim.clips.multi_ball_clip",
    "RelativeSetpoint": "matchset.control.follower",
    "RopeParameters": "matchset.sim.rope",
    "Scene": "matchset.sim.scene.scene",
    "ShapeClip": "matchset.sim.clips.shape_clip",
    "VehicleParameters": "matchset.sim.vehicle",
    "VehiclePose": "matchset.sim.vehicle",
    "World": "matchset.sim.world",
    "WorldCameras": "matchset.sim.cameras",
    "camera_position": "matchset.sim.world",
    "degrade": "matchset.sim.analog_link",
    "relative_position": "matchset.sim.world",
    "toy": "matchset.sim.vehicle",
}

if not TYPE_CHECKING:  # a type checker that sees `__getattr__` takes every misspelled name for a public one
    __getattr__ = lazy_names(__name__, _MODULES)


def __dir__() -> list[str]:
    """List what is public, loaded yet or not, and what every module has."""
    return sorted({*(name for name in globals() if name.startswith("__")), *__all__})
