"""From tracks to poses: position, rotation and their covariance.

Read `pose` and `ball_target` first (the data), then `localizer`, which users call. Below it: `cone` (position from the
outline), `attitude` (rotation from markers), `marker_identification` (which marker is which), `pose_estimation` (all in
one compiled call). `pose_filter` smooths and predicts, `chain` composes poses along a chain of vehicles.
Folders: `markers` finds the markers in the image, `neighbors` follows several balls at once,
`next_ball` the one behind the neighbor.
"""
