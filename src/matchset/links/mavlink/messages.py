"""The messages that matchset sends and understands, with all their fields: the one table of them.

Names, types, units and numbers are those of MAVLink's definitions (`common.xml`; TARGET_RELATIVE: `development.xml`).
"""

from matchset.links.mavlink.message import Field, MavlinkMessage

HEARTBEAT = MavlinkMessage(
    0,
    "HEARTBEAT",
    "sent once a second; from the autopilot: its kind, whether it is armed, and its mode",
    (
        Field("type", "uint8_t", what="of the vehicle (2: quadrotor) or of the station (6: ground)"),
        Field("autopilot", "uint8_t", what="3: ArduPilot, 12: PX4, 8: none"),
        Field("base_mode", "uint8_t", what="flags; 128: armed, 1: `custom_mode` counts"),
        Field("custom_mode", "uint32_t", what="the autopilot's own number of its mode"),
        Field("system_status", "uint8_t", what="3: standby, 4: active, 5: critical, 6: emergency"),
        Field("mavlink_version", "uint8_t", what="3"),
    ),
)

SYS_STATUS = MavlinkMessage(
    1,
    "SYS_STATUS",
    "battery and health of the autopilot",
    (
        Field("onboard_control_sensors_present", "uint32_t", what="flags"),
        Field("onboard_control_sensors_enabled", "uint32_t", what="flags"),
        Field("onboard_control_sensors_health", "uint32_t", what="flags; 2^28: ready to be armed"),
        Field("load", "uint16_t", "d%", "of the processor"),
        Field("voltage_battery", "uint16_t", "mV", "65535: unknown"),
        Field("current_battery", "int16_t", "cA", "-1: unknown"),
        Field("battery_remaining", "int8_t", "%", "-1: unknown"),
        Field("drop_rate_comm", "uint16_t", "c%", "packets that it lost"),
        Field("errors_comm", "uint16_t", what="packets that it lost"),
        Field("errors_count1", "uint16_t", what="its own"),
        Field("errors_count2", "uint16_t", what="its own"),
        Field("errors_count3", "uint16_t", what="its own"),
        Field("errors_count4", "uint16_t", what="its own"),
        Field("onboard_control_sensors_present_extended", "uint32_t", what="flags", extension=True),
        Field("onboard_control_sensors_enabled_extended", "uint32_t", what="flags", extension=True),
        Field("onboard_control_sensors_health_extended", "uint32_t", what="flags", extension=True),
    ),
)

PARAM_REQUEST_READ = MavlinkMessage(
    20,
    "PARAM_REQUEST_READ",
    "asks for the settings that decide what silence does",
    (
        Field("target_system", "uint8_t"),
        Field("target_component", "uint8_t", what="1: the autopilot"),
        Field("param_id", "char[16]"),
        Field("param_index", "int16_t", what="-1: by its name"),
    ),
)

PARAM_VALUE = MavlinkMessage(
    22,
    "PARAM_VALUE",
    "the answer",
    (
        Field("param_id", "char[16]"),
        Field("param_value", "float", what="PX4 puts the bytes of an integer here"),
        Field("param_type", "uint8_t", what="9: float, otherwise an integer"),
        Field("param_count", "uint16_t"),
        Field("param_index", "uint16_t"),
    ),
)

ATTITUDE = MavlinkMessage(
    30,
    "ATTITUDE",
    "the autopilot's estimate of its attitude; asked for 20 times a second",
    (
        Field("time_boot_ms", "uint32_t", "ms", "since the autopilot started"),
        Field("roll", "float", "rad", "right side down"),
        Field("pitch", "float", "rad", "nose up"),
        Field("yaw", "float", "rad", "clockwise from north, seen from above"),
        Field("rollspeed", "float", "rad/s"),
        Field("pitchspeed", "float", "rad/s"),
        Field("yawspeed", "float", "rad/s"),
    ),
)

MANUAL_CONTROL = MavlinkMessage(
    69,
    "MANUAL_CONTROL",
    "the sticks, with every command",
    (
        Field("target", "uint8_t", what="system that is flown"),
        Field("x", "int16_t", what="pitch, -1000 ... 1000, forward"),
        Field("y", "int16_t", what="roll, -1000 ... 1000, to the right"),
        Field("z", "int16_t", what="throttle, 0 ... 1000"),
        Field("r", "int16_t", what="yaw, -1000 ... 1000, clockwise seen from above, as autopilots read it"),
        Field("buttons", "uint16_t", what="0: none"),
        Field("buttons2", "uint16_t", what="0: none", extension=True),
        Field("enabled_extensions", "uint8_t", what="0: none of the fields that follow", extension=True),
        Field("s", "int16_t", extension=True),
        Field("t", "int16_t", extension=True),
        Field("aux1", "int16_t", extension=True),
        Field("aux2", "int16_t", extension=True),
        Field("aux3", "int16_t", extension=True),
        Field("aux4", "int16_t", extension=True),
        Field("aux5", "int16_t", extension=True),
        Field("aux6", "int16_t", extension=True),
    ),
)

COMMAND_LONG = MavlinkMessage(
    76,
    "COMMAND_LONG",
    "arm and disarm (400), choose a mode (176), ask for a message's rate (511)",
    (
        Field("target_system", "uint8_t"),
        Field("target_component", "uint8_t", what="1: the autopilot"),
        Field("command", "uint16_t"),
        Field("confirmation", "uint8_t", what="number of the repetition"),
        *(Field(f"param{k}", "float") for k in range(1, 8)),
    ),
)

COMMAND_ACK = MavlinkMessage(
    77,
    "COMMAND_ACK",
    "the autopilot's answer to a command",
    (
        Field("command", "uint16_t"),
        Field("result", "uint8_t", what="0: accepted, 1: temporarily rejected, 2: denied, 4: failed, 5: in progress"),
        Field("progress", "uint8_t", "%", "255: unknown", extension=True),
        Field("result_param2", "int32_t", extension=True),
        Field("target_system", "uint8_t", what="who asked; 0: everybody", extension=True),
        Field("target_component", "uint8_t", extension=True),
    ),
)

SET_POSITION_TARGET_LOCAL_NED = MavlinkMessage(
    84,
    "SET_POSITION_TARGET_LOCAL_NED",
    "a velocity to fly at, in GUIDED or OFFBOARD mode",
    (
        Field("time_boot_ms", "uint32_t", "ms", "time of the sender"),
        Field("target_system", "uint8_t"),
        Field("target_component", "uint8_t"),
        Field("coordinate_frame", "uint8_t", what="8: forward, right, down; level, turned with the vehicle"),
        Field("type_mask", "uint16_t", what="flags of what is to be ignored"),
        Field("x", "float", "m"),
        Field("y", "float", "m"),
        Field("z", "float", "m"),
        Field("vx", "float", "m/s"),
        Field("vy", "float", "m/s"),
        Field("vz", "float", "m/s"),
        Field("afx", "float", "m/s/s"),
        Field("afy", "float", "m/s/s"),
        Field("afz", "float", "m/s/s"),
        Field("yaw", "float", "rad"),
        Field("yaw_rate", "float", "rad/s", "clockwise seen from above"),
    ),
)

TIMESYNC = MavlinkMessage(
    111,
    "TIMESYNC",
    "both clocks compared, once a second; the autopilot's questions are answered",
    (
        Field("tc1", "int64_t", "ns", "clock of who answers; 0: a question"),
        Field("ts1", "int64_t", "ns", "clock of who asks"),
    ),
)

BATTERY_STATUS = MavlinkMessage(
    147,
    "BATTERY_STATUS",
    "charge of the battery",
    (
        Field("id", "uint8_t", what="of the battery, from 0"),
        Field("battery_function", "uint8_t"),
        Field("type", "uint8_t", what="its chemistry"),
        Field("temperature", "int16_t", "cdegC", "32767: unknown"),
        Field("voltages", "uint16_t[10]", "mV", "of its cells; 65535: none"),
        Field("current_battery", "int16_t", "cA", "-1: unknown"),
        Field("current_consumed", "int32_t", "mAh", "-1: unknown"),
        Field("energy_consumed", "int32_t", "hJ", "-1: unknown"),
        Field("battery_remaining", "int8_t", "%", "-1: unknown"),
        Field("time_remaining", "int32_t", "s", "0: unknown", extension=True),
        Field("charge_state", "uint8_t", what="2: low, 3: critical", extension=True),
        Field("voltages_ext", "uint16_t[4]", "mV", "of its cells 11 to 14; 0: none", extension=True),
        Field("mode", "uint8_t", extension=True),
        Field("fault_bitmask", "uint32_t", extension=True),
    ),
)

LANDING_TARGET = MavlinkMessage(
    149,
    "LANDING_TARGET",
    "the ball as the vehicle's camera sees it, for ArduPilot's precision landing",
    (
        Field("time_usec", "uint64_t", "us", "when the picture was taken"),
        Field("target_num", "uint8_t"),
        Field("frame", "uint8_t", what="12: forward, right, down, fixed to the vehicle"),
        Field("angle_x", "float", "rad", "of the ball to the right of the axis"),
        Field("angle_y", "float", "rad", "of the ball below the axis"),
        Field("distance", "float", "m"),
        Field("size_x", "float", "rad"),
        Field("size_y", "float", "rad"),
        Field("x", "float", "m", "forward", extension=True),
        Field("y", "float", "m", "right", extension=True),
        Field("z", "float", "m", "down", extension=True),
        Field("q", "float[4]", what="w, x, y, z; 1, 0, 0, 0 where it is not observed", extension=True),
        Field("type", "uint8_t", what="2: seen by a camera", extension=True),
        Field("position_valid", "uint8_t", what="1: x, y, z count", extension=True),
    ),
)

STATUSTEXT = MavlinkMessage(
    253,
    "STATUSTEXT",
    "what the autopilot says in words: why it does not arm",
    (
        Field("severity", "uint8_t", what="0: emergency ... 4: warning ... 7: debug"),
        Field("text", "char[50]"),
        Field("id", "uint16_t", what="of a text in several pieces; 0: in one", extension=True),
        Field("chunk_seq", "uint8_t", what="number of the piece", extension=True),
    ),
)

ODOMETRY = MavlinkMessage(
    331,
    "ODOMETRY",
    "where the vehicle is, with covariance, for the autopilot's own estimator",
    (
        Field("time_usec", "uint64_t", "us", "when the picture was taken"),
        Field("frame_id", "uint8_t", what="20: forward, right, down, as the reference stands"),
        Field("child_frame_id", "uint8_t", what="12: forward, right, down, fixed to the vehicle"),
        Field("x", "float", "m", "forward"),
        Field("y", "float", "m", "right"),
        Field("z", "float", "m", "down"),
        Field("q", "float[4]", what="w, x, y, z; turns the vehicle's axes into the reference's"),
        Field("vx", "float", "m/s", "NaN: not measured"),
        Field("vy", "float", "m/s", "NaN: not measured"),
        Field("vz", "float", "m/s", "NaN: not measured"),
        Field("rollspeed", "float", "rad/s", "NaN: not measured"),
        Field("pitchspeed", "float", "rad/s", "NaN: not measured"),
        Field("yawspeed", "float", "rad/s", "NaN: not measured"),
        Field("pose_covariance", "float[21]", what="upper triangle, by rows: x, y, z, roll, pitch, yaw"),
        Field("velocity_covariance", "float[21]", what="NaN first: unknown"),
        Field("reset_counter", "uint8_t", what="one more whenever another reference begins", extension=True),
        Field("estimator_type", "uint8_t", what="2: vision", extension=True),
        Field("quality", "int8_t", "%", "-1: failed, 0: unknown", extension=True),
    ),
)

TARGET_RELATIVE = MavlinkMessage(
    511,
    "TARGET_RELATIVE",
    "the ball as the vehicle's camera sees it, with standard deviations, for PX4 1.18",
    (
        Field("timestamp", "uint64_t", "us", "when the picture was taken"),
        Field("id", "uint8_t"),
        Field("frame", "uint8_t", what="1: forward, right, down, fixed to the vehicle"),
        Field("x", "float", "m", "forward"),
        Field("y", "float", "m", "right"),
        Field("z", "float", "m", "down"),
        Field("pos_std", "float[3]", "m", "standard deviations of x, y, z"),
        Field("yaw_std", "float", "rad"),
        Field("q_target", "float[4]", what="w, x, y, z of the ball; 1, 0, 0, 0 where it is not observed"),
        Field("q_sensor", "float[4]", what="w, x, y, z of the vehicle to north, east, down; 0: unknown"),
        Field("type", "uint8_t", what="2: seen by a camera"),
    ),
)

MESSAGES = (
    HEARTBEAT,
    SYS_STATUS,
    PARAM_REQUEST_READ,
    PARAM_VALUE,
    ATTITUDE,
    MANUAL_CONTROL,
    COMMAND_LONG,
    COMMAND_ACK,
    SET_POSITION_TARGET_LOCAL_NED,
    TIMESYNC,
    BATTERY_STATUS,
    LANDING_TARGET,
    STATUSTEXT,
    ODOMETRY,
    TARGET_RELATIVE,
)
BY_ID = {message.id: message for message in MESSAGES}
BY_NAME = {message.name: message for message in MESSAGES}
