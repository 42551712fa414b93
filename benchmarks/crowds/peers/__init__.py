"""Trackers of others that give names to detections, each in an environment of its own; trackpy in that of benchmarks.

Read `peer.py`, what a peer is; then `norfair.py`, `sort_family.py` and `trackpy.py`, and `process.py`, which runs one.
`finders/`: how some find balls without matchset. `search.py` finds the best parameters of each on seeds that are not
reported and writes `parameters.toml`. What runs in a process of its own imports no matchset.
"""
