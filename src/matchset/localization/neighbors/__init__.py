"""Several balls at once: each keeps its identity while others cross or hide it.

Read `neighbors` first: it tracks every ball, nearest first, and associates detections with lost balls. `ball_track` is
one ball with its markers and pose; `ball_search` detects balls that nobody follows.
"""
