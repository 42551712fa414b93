"""Keys that files had before 2026-11-28, when each became the name of its parameter: `with_newer_keys`.

A key of now is never an older one of the same table, so a file may have both kinds, but not both of one parameter.
"""

from collections.abc import Mapping
from typing import Any, get_args

import msgspec

# format: of controllers by angles and by speeds
_CONTROLLERS = {
    "level": "horizontal",
    "rise": "vertical",
    "lead": "horizontal_lead",
    "rise_lead": "vertical_lead",
    "ahead": "oscillation_feedforward",
    "drift": "drift_feedforward",
    "pace": "horizontal_feedforward",
    "rise_pace": "vertical_feedforward",
}
# format: the older key and the name of the parameter, by the class of the table that both are in
OLDER_KEYS: dict[str, dict[str, str]] = {
    "FlightParameters": {
        "long": "long_chain",
    },
    "FollowerParameters": {
        **_CONTROLLERS,
        "hover": "hover_throttle",
        "own": "ego_motion",
        "motion": "neighbor_filter",
        "answer": "motion_consistency",
        "thrust": "thrust_estimator",
        "common": "common_motion",
        "beyond": "next_but_one",
        "schedule": "gain_schedule",
        "steady": "stability",
        "reach": "max_extrapolation",
        "memory": "pose_timeout",
        "alone": "max_yaw_sigma",
    },
    "PidParameters": {
        "smoothing": "derivative_filter_time",
        "stride": "max_error",
        "most": "output_limit",
        "most_integral": "integral_limit",
        "within": "integral_zone",
        "foresight": "integral_lead",
        "learning": "integral_decay_time",
        "settled": "integral_floor",
    },
    "FeedforwardParameters": {
        "share": "high_frequency_gain",
        "calm": "crossover_time",
    },
    "EgoMotionParameters": {
        "heft": "effective_mass_ratio",
        "told_speeds": "speed_commands",
    },
    "NeighborFilterParameters": {
        "acceleration": "acceleration_sigma",
        "turning": "yaw_acceleration_sigma",
        "lasting": "acceleration_time",
        "turn_lasting": "yaw_acceleration_time",
        "period": "oscillation_period",
        "damping": "oscillation_damping",
        "sway": "oscillation_sigma",
        "turn_sway": "yaw_oscillation_sigma",
        "tilt": "tilt_sigma",
        "yaw": "yaw_sigma",
        "shared": "systematic_sigma",
        "jump": "max_jump",
        "patience": "max_rejected",
    },
    "MotionConsistencyParameters": {
        "few": "min_latency_count",
        "least": "min_evidence_count",
        "after": "min_changed_count",
        "spacing": "delay_spacing",
        "earliest": "min_delay",
        "latest": "max_delay",
        "far": "min_old_delay",
        "oldest": "max_old_delay",
        "memory": "moving_average",
        "limit": "max_evidence",
        "agreeing": "confirmations",
        "begin": "settling_time",
        "latency": "delay_estimator",
    },
    "DelayEstimatorParameters": {
        "quick": "min_time",
        "slow": "max_time",
        "pace": "max_rate",
    },
    "ThrustEstimatorParameters": {
        "doubt": "initial_sigma",
        "change": "gain_noise",
        "shaking": "acceleration_noise",
        "airborne": "airborne_ratio",
        "smallest": "min_gain",
        "largest": "max_gain",
    },
    "CommonMotionParameters": {
        "level": "horizontal_time",
        "rise": "vertical_time",
        "takeoff_lasts": "takeoff_duration",
        "takeoff": "takeoff_time",
    },
    "MountParameters": {
        "doubt": "pitch_sigma",
        "marker_doubt": "marker_sigma",
        "change": "elevation_noise",
        "begin": "settling_time",
        "evident": "significance",
        "most": "max_correction",
        "rate": "max_rate",
        "nearest": "min_marker_cosine",
    },
    "NextButOneParameters": {
        "slow": "time_constant",
        "delay": "reference_delay",
        "power": "delay_exponent",
        "longest": "max_time_constant",
        "forgetting": "forgetting_rate",
        "rise": "height_difference",
        "fade": "fade_time",
        "memory": "pose_timeout",
        "known": "local_search_time",
    },
    "GainScheduleParameters": {
        "most": "output_limit",
        "stride": "max_error",
        "pace": "horizontal_share",
        "rise_pace": "vertical_share",
        "rise_drift": "vertical_drift_feedforward",
        "begin": "start_time",
        "full": "full_time",
        "forgetting": "forgetting_rate",
    },
    "StabilityParameters": {
        "used": "enabled",
        "gain_margin": "gain_margin_db",
        "phase_margin": "phase_margin_deg",
        "delay_doubt": "delay_uncertainty",
        "rise_swing": "throttle_swing",
        "again": "lowered_swing_ratio",
        "swings": "swing_count",
        "longest": "max_half_period",
        "turning": "turning_ratio",
        "lowering": "lowering_factor",
        "least": "min_factor",
        "begin": "settling_time",
        "averaging": "averaging_time",
    },
    "SpeedParameters": {**_CONTROLLERS, "takeoff": "takeoff_duration"},
    "SafetyParameters": {
        "tilt": "max_tilt",
        "yaw": "max_yaw",
        "least_throttle": "min_throttle",
        "most_throttle": "max_throttle",
        "reserve": "throttle_reserve",
        "most_hover": "max_hover",
        "most_hover_time": "max_hover_time",
        "slew": "max_stick_rate",
        "throttle_slew": "max_throttle_rate",
        "fresh": "max_frame_age",
        "hold": "hold_time",
        "seen_again": "reacquisition_time",
        "nearest": "min_distance",
        "near": "max_near_time",
        "descent": "descent_duration",
        "descent_throttle": "final_throttle_ratio",
    },
    "LongChainParameters": {
        "short": "short_followers",
        "long": "long_followers",
        "elsewhere": "remote_followers",
        "tilt": "tilt_sigma",
    },
}


def newer_key(key: str, kind: type | None) -> str:
    """Return the name of the parameter that a key is of; the key itself if it is no older one.

    Parameters
    ----------
    key : str
    kind : type or None
        The `msgspec.Struct` of the table that the key is in; None if it is of none.
    """
    return OLDER_KEYS.get("" if kind is None else kind.__name__, {}).get(key, key)


def kind_of(key: str, kind: type | None) -> type | None:
    """Return the struct of a table, or of each table of an array, by its key in the table around it.

    Parameters
    ----------
    key : str
        Of now.
    kind : type or None
        The struct of the table around it.

    Returns
    -------
    type or None
        None where the key is not that of a table, or is unknown.
    """
    fields = () if kind is None else msgspec.structs.fields(kind)
    found = next((field.type for field in fields if field.name == key), None)
    inner = [each for each in (found, *get_args(found)) if isinstance(each, type) and issubclass(each, msgspec.Struct)]
    return inner[0] if inner else None


def with_newer_keys(table: Mapping[str, Any], kind: type | None) -> tuple[dict[str, Any], list[tuple[str, str]]]:
    """Return a table with the keys of now, and which older ones it had.

    Parameters
    ----------
    table : mapping
        As it was parsed; keys that are unknown stay.
    kind : type or None
        The `msgspec.Struct` that it is to become.

    Returns
    -------
    table : dict
    older : list of (str, str)
        Older keys and those of now, with the tables that they are in: ``("pilot.safety.hold",
        "pilot.safety.hold_time")``.

    Raises
    ------
    ValueError
        If a parameter is there under both of its keys.
    """
    newer: dict[str, Any] = {}
    older: list[tuple[str, str]] = []
    for key, value in table.items():
        name = newer_key(key, kind)
        if name in newer or (name != key and name in table):
            raise ValueError(f"{name} is there twice: {key} is its older name")
        older += [(key, name)] if name != key else []
        newer[name], within = _newer_value(value, kind_of(name, kind))
        older += [(f"{key}.{before}", f"{name}.{now}") for before, now in within]
    return newer, older


def _newer_value(value: Any, kind: type | None) -> tuple[Any, list[tuple[str, str]]]:
    """Return a value with the keys of now: a table, an array of tables, or anything else as it is."""
    if isinstance(value, Mapping):
        return with_newer_keys(value, kind)
    if isinstance(value, list) and kind is not None:
        pairs = [_newer_value(each, kind) for each in value]
        return [each for each, _ in pairs], [one for _, found in pairs for one in found]
    return value, []
