"""Structs of the firmware as this computer's compiler lays them out, to call its functions one by one."""

import ctypes
import functools
from collections.abc import Sequence

import toolchain

STATES = ("binding", "locked", "armed", "holding", "failsafe")


class Sticks(ctypes.Structure):
    _fields_ = (
        ("throttle", ctypes.c_uint8),
        ("pitch", ctypes.c_int8),
        ("yaw", ctypes.c_int8),
        ("roll", ctypes.c_int8),
        ("fast", ctypes.c_bool),
        ("flip", ctypes.c_bool),
    )


class Crsf(ctypes.Structure):
    _fields_ = (
        ("bytes", ctypes.c_uint8 * 26),
        ("count", ctypes.c_uint8),
        ("whole", ctypes.c_bool),
        ("bad", ctypes.c_uint16),
        ("channels", ctypes.c_uint16 * 16),
    )


class Pilot(ctypes.Structure):
    _fields_ = (
        ("state", ctypes.c_uint),
        ("low_frames", ctypes.c_uint8),
        ("age", ctypes.c_uint16),
        ("bind_left", ctypes.c_uint16),
        ("heard", Sticks),
        ("before", Sticks),
        ("flown", Sticks),
    )


@functools.cache
def library() -> ctypes.CDLL:
    """The firmware's functions."""
    found = ctypes.CDLL(str(toolchain.host_library()))
    found.crsf_next.restype = found.pilot_bind.restype = found.pilot_flying.restype = ctypes.c_bool
    found.pilot_sticks.restype = Sticks
    return found


def parse(stream: bytes) -> tuple[list[tuple[int, bytes]], Crsf]:
    """Feed bytes to the firmware's parser; type and payload of each frame that it found, and its struct."""
    crsf, found = Crsf(), []
    for byte in stream:
        library().crsf_take(ctypes.byref(crsf), byte)
        while library().crsf_next(ctypes.byref(crsf)):
            found.append((crsf.bytes[2], bytes(crsf.bytes[3 : crsf.bytes[1] + 1])))
    return found, crsf


def hear(pilot: Pilot, channels: Sequence[int]) -> None:
    """Hand a good frame's channels to the pilot."""
    library().pilot_frame(ctypes.byref(pilot), (ctypes.c_uint16 * 16)(*channels))
