"""The camera in the page: its model, and how it is set.

`camera_panel` shows what is known of it and takes what a person knows: a file (`camera_files`), a board that is held
before it (`board_calibration`), or a ball at a known distance (`ball_distance`).
"""
