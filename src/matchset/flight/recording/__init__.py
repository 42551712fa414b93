"""Recordings of flights, and their replay through the same code, bit for bit.

Read `messages` (what is in a file: the format), `encoding` (steps and pictures to messages and back) and `mcap_file`
(messages in a file), then `writer` and `reader`. `ros_messages` gives tools of ROS what they can show, in the
types and bytes of `sharing/ros2`. `replay` runs the pilots on a recording with the `devices` that repeat
it, and compares every step; `command` is `matchset replay`. `coded_camera` codes pictures before they are flown.
"""
