"""Learned: what a follower finds out about its own vehicle while it flies, beside the throttle that hovers.

`delay.py` estimates a latency that was not told, from what `motion_consistency.py` compares. It is bounded.
`common_motion.py` decides whose velocity a picture shows, the vehicle's or its neighbor's.
"""
