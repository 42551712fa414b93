"""The command `matchset calibrate`: a camera's focal length and lens distortion.

Read `command` with its `options` first (board or ball?). With a board: `board_sheet` (one to print), `board_command`
(the run), `board_views` (finding it in frames) and `coverage_picture` (the report as a picture). With a ball of known
size: `ball_command` (the run) and `still_ball` (when the ball is held still). `mount_command` finds how a camera is
turned on its vehicle.
"""
