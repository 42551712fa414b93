"""The command `matchset locate`: where a ball of known size is, in meters.

Read `command` with its `options` first, then `run`, `what_options_name` (ball, camera, colors, from their files),
`loop` (each frame through tracker, markers and localizer; the path), and `rows` (the table). `annotate_pose` draws a
pose into its frame, `path_picture` the path of a run.
"""
