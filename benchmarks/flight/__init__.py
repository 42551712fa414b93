"""Simulated flights: rows of twenty, scored, and how long a follower takes for a picture.

`fly` flies the rows of benchmarks/FLIGHT.md and writes that page; `faults` flies by frozen and stale pictures, and
without fault for false alarms; `processing` times the steps of a follower.
`mismatch` flies the rows of ``mismatch.toml``, where the simulated side is not what the followers are told.
`outside` plays transmitter, world and camera in real time for `benchmarks.pauses`.
"""
