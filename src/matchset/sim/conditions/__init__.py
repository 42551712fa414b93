"""What differs between the simulated side and what a controller is told.

`conditions.py` holds the one struct of names, each with meaning, unit, range and default: `Conditions`. A chain, its
cameras and its links read it; nobody that controls a vehicle does. `outlines.py` gives the outlines of the balls from
the truth, for flights without pictures, with the errors of `outline_noise.py`; `gusts.py` decides how the air moves.
"""
