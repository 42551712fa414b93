"""The messages that matchset sends and understands, with all their fields: the one table of them.

Names, types, units and numbers are those of MAVLink's definitions (`common.xml`; TARGET_RELATIVE: `development.xml`).
"""

from matchset.links.mavlink.message import MavlinkMessage, MessageField

HEARTBEAT = MavlinkMessage(
    0,
    "HEARTBEAT",
    "sent once a second; from the autopilot: its kind, whether it is armed, and its mode",
    (
        MessageField("type", "uint8_t", what="of the vehicle (2: quadrotor) or of the station (6: ground)"),
        MessageField("autopilot", "uint8_t", what="3: ArduPilot, 12: PX4, 8: none"),
        MessageField("base_mode", "uint8_t", what="flags; 128: armed, 1: `custom_mode` counts"),
        MessageField("custom_mode", "uint32_t", what="the autopilot's own number of its mode"),
        MessageField("system_status", "uint8_t", what="3: standby, 4: active, 5: critical, 6: emergency"),
        MessageField("mavlink_version", "uint8_t", what="3"),
    ),
)

SYS_STATUS = MavlinkMessage(
    1,
    "SYS_STATUS",
    "battery and health of the autopilot",
    (
        MessageField("onboard_control_sensors_present", "uint32_t", what="flags"),
        MessageField("onboard_control_sensors_enabled", "uint32_t", what="flags"),
        MessageField("onboard_control_sensors_health", "uint32_t", what="flags; 2^28: ready to be armed"),
        MessageField("load", "uint16_t", "d%", "of the processor"),
        MessageField("voltage_battery", "uint16_t", "mV", "65535: unknown"),
        MessageField("current_battery", "int16_t", "cA", "-1: unknown"),
        MessageField("battery_remaining", "int8_t", "%", "-1: unknown"),
        MessageField("drop_rate_comm", "uint16_t", "c%", "packets that it lost"),
        MessageField("errors_comm", "uint16_t", what="packets that it lost"),
        MessageField("errors_count1", "uint16_t", what="its own"),
        MessageField("errors_count2", "uint16_t", what="its own"),
        MessageField("errors_count3", "uint16_t", what="its own"),
        MessageField("errors_count4", "uint16_t", what="its own"),
        MessageField("onboard_control_sensors_present_extended", "uint32_t", what="flags", extension=True),
        MessageField("onboard_control_sensors_enabled_extended", "uint32_t", what="flags", extension=True),
        MessageField("onboard_control_sensors_health_extended", "uint32_t", what="flags", extension=True),
    ),
)

PARAM_REQUEST_READ = MavlinkMessage(
    20,
    "PARAM_REQUEST_READ",
    "asks for the settings that decide what silence does",
    (
        MessageField("target_system", "uint8_t"),
        MessageField("target_component", "uint8_t", what="1: the autopilot"),
        MessageField("param_id", "char[16]"),
        MessageField("param_index", "int16_t", what="-1: by its name"),
    ),
)

PARAM_VALUE = MavlinkMessage(
    22,
    "PARAM_VALUE",
    "the answer",
    (
        MessageField("param_id", "char[16]"),
        MessageField("param_value", "float", what="PX4 puts the bytes of an integer here"),
        MessageField("param_type", "uint8_t", what="9: float, otherwise an integer"),
        MessageField("param_count", "uint16_t"),
        MessageField("param_index", "uint16_t"),
    ),
)

ATTITUDE = MavlinkMessage(
    30,
    "ATTITUDE",
    "the autopilot's estimate of its attitude; asked for 20 times a second",
    (
        MessageField("time_boot_ms", "uint32_t", "ms", "since the autopilot started"),
        MessageField("roll", "float", "rad", "right side down"),
        MessageField("pitch", "float", "rad", "nose up"),
        MessageField("yaw", "float", "rad", "clockwise from north, seen from above"),
        MessageField("rollspeed", "float", "rad/s"),
        MessageField("pitchspeed", "float", "rad/s"),
        MessageField("yawspeed", "float", "rad/s"),
    ),
)

MANUAL_CONTROL = MavlinkMessage(
    69,
    "MANUAL_CONTROL",
    "the sticks, with every command",
    (
        MessageField("target", "uint8_t", what="system that is flown"),
        MessageField("x", "int16_t", what="pitch, -1000 ... 1000, forward"),
        MessageField("y", "int16_t", what="roll, -1000 ... 1000, to the right"),
        MessageField("z", "int16_t", what="throttle, 0 ... 1000"),
        MessageField("r", "int16_t", what="yaw, -1000 ... 1000, clockwise seen from above, as autopilots read it"),
        MessageField("buttons", "uint16_t", what="0: none"),
        MessageField("buttons2", "uint16_t", what="0: none", extension=True),
        MessageField("enabled_extensions", "uint8_t", what="0: none of the fields that follow", extension=True),
        MessageField("s", "int16_t", extension=True),
        MessageField("t", "int16_t", extension=True),
        MessageField("aux1", "int16_t", extension=True),
        MessageField("aux2", "int16_t", extension=True),
        MessageField("aux3", "int16_t", extension=True),
        MessageField("aux4", "int16_t", extension=True),
        MessageField("aux5", "int16_t", extension=True),
        MessageField("aux6", "int16_t", extension=True),
    ),
)

COMMAND_LONG = MavlinkMessage(
    76,
    "COMMAND_LONG",
    "arm and disarm (400), choose a mode (176), ask for a message's rate (511)",
    (
        MessageField("target_system", "uint8_t"),
        MessageField("target_component", "uint8_t", what="1: the autopilot"),
        MessageField("command", "uint16_t"),
        MessageField("confirmation", "uint8_t", what="number of the repetition"),
        *(MessageField(f"param{k}", "float") for k in range(1, 8)),
    ),
)

COMMAND_ACK = MavlinkMessage(
    77,
    "COMMAND_ACK",
    "the autopilot's answer to a command",
    (
        MessageField("command", "uint16_t"),
        MessageField(
            "result", "uint8_t", what="0: accepted, 1: temporarily rejected, 2: denied, 4: failed, 5: in progress"
        ),
        MessageField("progress", "uint8_t", "%", "255: unknown", extension=True),
        MessageField("result_param2", "int32_t", extension=True),
        MessageField("target_system", "uint8_t", what="who asked; 0: everybody", extension=True),
        MessageField("target_component", "uint8_t", extension=True),
    ),
)

SET_POSITION_TARGET_LOCAL_NED = MavlinkMessage(
    84,
    "SET_POSITION_TARGET_LOCAL_NED",
    "a velocity to fly at, in GUIDED or OFFBOARD mode",
    (
        MessageField("time_boot_ms", "uint32_t", "ms", "time of the sender"),
        MessageField("target_system", "uint8_t"),
        MessageField("target_component", "uint8_t"),
        MessageField("coordinate_frame", "uint8_t", what="8: forward, right, down; level, turned with the vehicle"),
        MessageField("type_mask", "uint16_t", what="flags of what is to be ignored"),
        MessageField("x", "float", "m"),
        MessageField("y", "float", "m"),
        MessageField("z", "float", "m"),
        MessageField("vx", "float", "m/s"),
        MessageField("vy", "float", "m/s"),
        MessageField("vz", "float", "m/s"),
        MessageField("afx", "float", "m/s/s"),
        MessageField("afy", "float", "m/s/s"),
        MessageField("afz", "float", "m/s/s"),
        MessageField("yaw", "float", "rad"),
        MessageField("yaw_rate", "float", "rad/s", "clockwise seen from above"),
    ),
)

TIMESYNC = MavlinkMessage(
    111,
    "TIMESYNC",
    "both clocks compared, once a second; the autopilot's questions are answered",
    (
        MessageField("tc1", "int64_t", "ns", "clock of who answers; 0: a question"),
        MessageField("ts1", "int64_t", "ns", "clock of who asks"),
    ),
)

BATTERY_STATUS = MavlinkMessage(
    147,
    "BATTERY_STATUS",
    "charge of the battery",
    (
        MessageField("id", "uint8_t", what="of the battery, from 0"),
        MessageField("battery_function", "uint8_t"),
        MessageField("type", "uint8_t", what="its chemistry"),
        MessageField("temperature", "int16_t", "cdegC", "32767: unknown"),
        MessageField("voltages", "uint16_t[10]", "mV", "of its cells; 65535: none"),
        MessageField("current_battery", "int16_t", "cA", "-1: unknown"),
        MessageField("current_consumed", "int32_t", "mAh", "-1: unknown"),
        MessageField("energy_consumed", "int32_t", "hJ", "-1: unknown"),
        MessageField("battery_remaining", "int8_t", "%", "-1: unknown"),
        MessageField("time_remaining", "int32_t", "s", "0: unknown", extension=True),
        MessageField("charge_state", "uint8_t", what="2: low, 3: critical", extension=True),
        MessageField("voltages_ext", "uint16_t[4]", "mV", "of its cells 11 to 14; 0: none", extension=True),
        MessageField("mode", "uint8_t", extension=True),
        MessageField("fault_bitmask", "uint32_t", extension=True),
    ),
)

LANDING_TARGET = MavlinkMessage(
    149,
    "LANDING_TARGET",
    "the ball as the vehicle's camera sees it, for ArduPilot's precision landing",
    (
        MessageField("time_usec", "uint64_t", "us", "when the picture was taken"),
        MessageField("target_num", "uint8_t"),
        MessageField("frame", "uint8_t", what="12: forward, right, down, fixed to the vehicle"),
        MessageField("angle_x", "float", "rad", "of the ball to the right of the axis"),
        MessageField("angle_y", "float", "rad", "of the ball below the axis"),
        MessageField("distance", "float", "m"),
        MessageField("size_x", "float", "rad"),
        MessageField("size_y", "float", "rad"),
        MessageField("x", "float", "m", "forward", extension=True),
        MessageField("y", "float", "m", "right", extension=True),
        MessageField("z", "float", "m", "down", extension=True),
        MessageField("q", "float[4]", what="w, x, y, z; 1, 0, 0, 0 where it is not observed", extension=True),
        MessageField("type", "uint8_t", what="2: seen by a camera", extension=True),
        MessageField("position_valid", "uint8_t", what="1: x, y, z count", extension=True),
    ),
)

STATUSTEXT = MavlinkMessage(
    253,
    "STATUSTEXT",
    "what the autopilot says in words: why it does not arm",
    (
        MessageField("severity", "uint8_t", what="0: emergency ... 4: warning ... 7: debug"),
        MessageField("text", "char[50]"),
        MessageField("id", "uint16_t", what="of a text in several pieces; 0: in one", extension=True),
        MessageField("chunk_seq", "uint8_t", what="number of the piece", extension=True),
    ),
)

ODOMETRY = MavlinkMessage(
    331,
    "ODOMETRY",
    "where the vehicle is, with covariance, for the autopilot's own estimator",
    (
        MessageField("time_usec", "uint64_t", "us", "when the picture was taken"),
        MessageField("frame_id", "uint8_t", what="20: forward, right, down, as the reference stands"),
        MessageField("child_frame_id", "uint8_t", what="12: forward, right, down, fixed to the vehicle"),
        MessageField("x", "float", "m", "forward"),
        MessageField("y", "float", "m", "right"),
        MessageField("z", "float", "m", "down"),
        MessageField("q", "float[4]", what="w, x, y, z; turns the vehicle's axes into the reference's"),
        MessageField("vx", "float", "m/s", "NaN: not measured"),
        MessageField("vy", "float", "m/s", "NaN: not measured"),
        MessageField("vz", "float", "m/s", "NaN: not measured"),
        MessageField("rollspeed", "float", "rad/s", "NaN: not measured"),
        MessageField("pitchspeed", "float", "rad/s", "NaN: not measured"),
        MessageField("yawspeed", "float", "rad/s", "NaN: not measured"),
        MessageField("pose_covariance", "float[21]", what="upper triangle, by rows: x, y, z, roll, pitch, yaw"),
        MessageField("velocity_covariance", "float[21]", what="NaN first: unknown"),
        MessageField("reset_counter", "uint8_t", what="one more whenever another reference begins", extension=True),
        MessageField("estimator_type", "uint8_t", what="2: vision", extension=True),
        MessageField("quality", "int8_t", "%", "-1: failed, 0: unknown", extension=True),
    ),
)

TARGET_RELATIVE = MavlinkMessage(
    511,
    "TARGET_RELATIVE",
    "the ball as the vehicle's camera sees it, with standard deviations, for PX4 1.18",
    (
        MessageField("timestamp", "uint64_t", "us", "when the picture was taken"),
        MessageField("id", "uint8_t"),
        MessageField("frame", "uint8_t", what="1: forward, right, down, fixed to the vehicle"),
        MessageField("x", "float", "m", "forward"),
        MessageField("y", "float", "m", "right"),
        MessageField("z", "float", "m", "down"),
        MessageField("pos_std", "float[3]", "m", "standard deviations of x, y, z"),
        MessageField("yaw_std", "float", "rad"),
        MessageField("q_target", "float[4]", what="w, x, y, z of the ball; 1, 0, 0, 0 where it is not observed"),
        MessageField("q_sensor", "float[4]", what="w, x, y, z of the vehicle to north, east, down; 0: unknown"),
        MessageField("type", "uint8_t", what="2: seen by a camera"),
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
