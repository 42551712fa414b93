"""Flying a chain: the loop of each follower, the flight of all of them, its commands, its score.

Read `pilot` (one follower: picture in, command out) and `flight` (all followers in the simulated world, and what is
fixed for a flight), then `config` with `flight.toml` (all parameters). `command` is `matchset fly`, with `live_view`,
`pacer`, and `outputs`, which gives each step to the view, the video, the recording and the report (`output_files`).
`score` and `log` make numbers of a flight. `outline_pilot` flies without pictures, for `matchset simulate --quick`.
"""
