"""The camera: from pixels to rays and back, its files, its calibration. Nothing here knows a ball but the last file.

Read `camera_model` first (what users hold), then `lens` (the kernels: distortion and its inverse). `camera_toml` and
`camera_yaml` read and write files. Calibration, in order: `board` (find its corners), `view_selection` (which views to
use), `calibrate` (Zhang), `calibration_report` (how good it is). `ball_focal_length` does it with the ball alone.
"""
