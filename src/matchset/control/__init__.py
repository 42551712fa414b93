"""Control: from poses of a neighbor's ball to stick commands.

Read `command.py` (what is sent), then `follower.py`, which holds a setpoint beside a neighbor. It uses `ego_motion.py`
(dead reckoning of the own vehicle), `neighbor_model.py` and `neighbor_filter.py` (Kalman filter of the neighbor),
`chain/` (the next-but-one ball), `mount/` (how the camera is turned on its vehicle), `learned/` (a latency that was not
told, the throttle that hovers), `sticks/` (what a stick means), `pid.py` and `feedforward.py`, `stability/` (how far
all of that is from oscillating), and answers with `control_output.py`. `safety.py` decides what of all that may be
sent; `repeated_picture.py` and `motion_consistency.py` say whether the pictures are new ones and those of now. `files/`
knows the keys that they had in files before.
"""
