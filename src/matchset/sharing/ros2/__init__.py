"""The same as ROS 2 sends it, without ROS: its messages in CDR, under the keys of rmw_zenoh.

Read `ros_keys` (keys, tokens and attachments of rmw_zenoh) and `ros_sender`, which sends targets. `ros_values` has the
values of messages, `ros_definitions` their types, `cdr` makes bytes of them, for recordings, too.
"""
