"""Simulated flights: rows of twenty, scored, and how long a follower takes for a picture.

`fly` flies the rows of benchmarks/FLIGHT.md and writes that page; `processing` times the steps of a follower.
`outside` plays transmitter, world and camera in real time for `benchmarks.pauses`.
"""
