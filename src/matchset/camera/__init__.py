"""The camera: from pixels to rays and back, its files, its calibration. Only the last two files know a ball.

Read `camera_model` first (what users hold), then `lens` (the kernels: distortion and its inverse). `camera_toml` and
`camera_yaml` read and write files. Calibration, in order: `board` (find its corners), `view_selection` (which views to
use), `calibrate` (Zhang), `calibration_report` (how good it is). `ball_focal_length` does it with
the ball alone, `one_ball_focal` from one place of it.
"""
