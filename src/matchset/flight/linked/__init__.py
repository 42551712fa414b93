"""Real vehicles: a camera and a link for each follower, flown by the same pilots as the simulated ones.

Read `linked_flight` first: the flight, step by step, by its contract `ChainFlight`; then `followers`, which steps, arms
and lands several pilots at once. `live_camera` and `dry_link` are a pilot's two ends: a camera that never makes the
loop wait, and a link that sends no throttle. `opening` makes all of it from `parameters`, which `options` (the
command line) or a TOML file hold; `run` flies, `briefing` says what will be, `vehicle_kind` what a link can do.
"""
