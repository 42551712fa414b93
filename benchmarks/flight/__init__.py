"""Simulated flights: rows of twenty, scored, and how long a follower takes for a picture.

`fly` flies the rows of ``flights.toml`` (`rows`), keeps each flight (`flown`) and writes benchmarks/FLIGHT.md (`page`).
`faults` flies by frozen and stale pictures, and without fault for false alarms; `processing` times the steps of a
follower. `outside` plays transmitter, world and camera in real time for `benchmarks.pauses`.
"""
