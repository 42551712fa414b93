"""The command `matchset locate`: where a ball of known size is, in meters.

Read `command` first (options and the run), then `options` (from options and files to ball, camera and colors), `loop`
(each frame through tracker, markers and localizer; the path), and `rows` (the table). `annotate_pose` draws a pose into
its frame, `path_picture` the path of a run.
"""
