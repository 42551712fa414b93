"""What sticks mean, angles and thrust (`angle_sticks.py`) or speeds (`speed_sticks.py`), and what comes of them.

A `Follower` finds accelerations for the one kind and speeds for the other by the same controllers; these two turn them
into sticks, and the sticks that were sent into what dead reckoning knows (`ego_parameters.py`).
"""
