"""A chain in flight: the loop of each follower, the flight of all of them, and what it was worth.

Read `pilot` (one follower: picture in, command out), `chain_step` (what all followers did with one picture each) and
`flight` (all followers in the simulated world), then `config` with `flight.toml` (all parameters, `flight_parameters`).
`score` makes numbers of a flight. `excitation` shakes the sticks to identify a vehicle, `outline_pilot` flies without
pictures, for `matchset simulate --quick`, and `pacer` holds a simulated flight to a clock.
"""
