"""The limits of the checks before a flight: `PreflightParameters`."""

import math

import msgspec

from matchset.numeric.arguments import require, require_at_least, require_positive, require_share, require_within


class PreflightParameters(msgspec.Struct, frozen=True, kw_only=True):
    """What the checks of `matchset preflight` want to see.

    All are chosen by hand, from what a follower needs that holds its place within 10 cm; nobody has flown by them yet.
    How old a picture may be is not here: `SafetyParameters.max_frame_age` and `GainSchedule`'s longest delay decide it
    in flight, and so they do before.

    Parameters
    ----------
    watch : float
        How long the camera is watched, s. More finds gaps that are rarer; less is over sooner.
    least_rate : float
        Fewest pictures a second. Less lets slower cameras fly, whose delay is longer; 15 is what the longest wait of
        the loop allows.
    longest_gap : float
        Longest time between two pictures, s. More forgives a camera that stutters; the safety filter descends after
        `SafetyParameters.max_frame_age`.
    most_repeats : float
        Largest share of pictures that came before, 0 ... 1. More lets a grabber fly that makes 30 of 25 a second.
    most_clipped : float
        Largest share of pixels that are as bright as they can be, 0 ... 1. More forgives a window in the picture; what
        is clipped has no color.
    most_dark : float
        Largest share of pixels that are nearly black, 0 ... 1. More lets a darker room pass.
    bright_level, dark_level : float
        From which value on, and below which, a pixel is meant by that, 0 ... 255; analog video is dark at 16.
    most_flicker : float
        Largest change of the mean brightness, standard deviation as a share of its mean. More forgives lamps that
        flicker and an exposure that swings.
    settle : float
        How long zero commands are sent before a link's state counts, s. Its vehicle must have spoken in that time.
    least_charge : float
        Least charge of the battery, 0 ... 1, where the link tells it. A first flight should not end by the battery.
    least_cell, full_cell : float
        Least voltage of a cell at rest, V, where only the voltage is told, and that of a full one, from which the
        number of cells follows: 4.35 V of those called HV.
    most_errors : float
        Largest share of messages that were not understood, 0 ... 1. More forgives a poor cable.
    stick, stick_time : float
        How far sticks are moved with the motors off, 0 ... 1, and how long each, s. More is seen better; a flight
        controller takes full sticks for commands of its menu.
    rest : float
        How long the vehicle is watched at rest at its set place, s. More tells noise and delays better.
    least_seen, least_marker : float
        Least share of the pictures in which the ball is tracked, and its marker, 0 ... 1. More asks for better colors
        and light.
    distance_error : float
        Largest difference of the seen distance from that of the set place, as a share. Wrong sizes and a wrong focal
        length show here; less asks for a better tape.
    most_noise, most_yaw_noise : float
        Largest noise from picture to picture, standard deviation, m and rad, of the position and of the direction of
        the marker. More flies with worse pictures, and shakes the sticks.
    most_off : float
        Largest distance from the set place at which a flight may begin, m. More lets it begin with a leap.
    busy : float
        Largest share of the time between two pictures that computing may take, in 99 of 100 pictures. More misses
        pictures.
    move_time : float
        How long a person has for each move, s.
    move_stick, move_steps : float, int
        How far the stick that would be sent must go, -1 ... 1, and for how many pictures in a row: then the move has
        been seen. Less takes a tremor for a move.
    recorded : float
        Length of a flight that must fit on the disk as a recording, s.
    """

    watch: float = 3.0
    least_rate: float = 15.0
    longest_gap: float = 0.15
    most_repeats: float = 0.0
    most_clipped: float = 0.1
    most_dark: float = 0.5
    bright_level: float = 250.0
    dark_level: float = 24.0
    most_flicker: float = 0.05
    settle: float = 1.0
    least_charge: float = 0.5
    least_cell: float = 3.8
    full_cell: float = 4.35
    most_errors: float = 0.02
    stick: float = 0.3
    stick_time: float = 1.0
    rest: float = 5.0
    least_seen: float = 0.98
    least_marker: float = 0.9
    distance_error: float = 0.1
    most_noise: float = 0.02
    most_yaw_noise: float = math.radians(3.0)
    most_off: float = 0.4
    busy: float = 1.0
    move_time: float = 20.0
    move_stick: float = 0.04
    move_steps: int = 8
    recorded: float = 60.0

    def __post_init__(self) -> None:
        shares = ("most_repeats", "most_clipped", "most_dark", "least_charge", "most_errors", "least_seen")
        levels = ("bright_level", "dark_level")
        require_share(self, (*shares, "least_marker"))
        require_within(self, dict.fromkeys(levels, (0.0, 255.0)))
        require(self, ("stick",), lambda value: 0.0 < value <= 0.5, "above 0 and at most 0.5")
        require_at_least(self, 1, "move_steps")
        rest = set(self.__struct_fields__) - {*shares, *levels, "least_marker", "stick", "move_steps"}
        require_positive(self, [name for name in self.__struct_fields__ if name in rest])
