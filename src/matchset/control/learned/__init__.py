"""Learned: what a follower finds out about its own vehicle while it flies.

`thrust_estimator.py` finds how much throttle hovers. `delay.py` estimates a latency that was not told, from what
`motion_consistency.py` compares. It is bounded.
`common_motion.py` decides whose velocity a picture shows, the vehicle's or its neighbor's.
"""
