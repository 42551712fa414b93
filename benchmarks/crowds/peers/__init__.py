"""Trackers of others that give names to detections, each in an environment of its own.

Read `peer.py`, what a peer is; then `norfair.py` and `sort_family.py`, and `process.py`, which runs one. `search.py`
finds the best parameters of each on seeds that are not reported and writes `parameters.toml`. Only `search.py` and
`client.py` import matchset.
"""
