"""Flying: a chain of quadcopters, simulated or real, and all that a flight needs before and after it.

Read `chain` first: one follower (`chain/pilot`), then all of them in one flight (`chain/flight`). `fly` is the command,
`linked` flies real vehicles by the same pilots, `real_time` keeps their loop on time. Before a flight: `radio`
(the transmitter), `preflight`, `identify` (what a controller must know of a vehicle). After it: `recording` (and
replay), `report`. `simulate` flies a series, `gym` is an environment for Gymnasium; `kill_switch` stops all motors.
"""
