"""How far a follower's loops are from oscillating, and what is done about it.

Read `loop.py` (the loops as frequency responses), `margins.py` (gain and phase margin), `oscillation.py` (swings that
are seen), then `gain_limit.py`, which lowers gains by both.
"""
