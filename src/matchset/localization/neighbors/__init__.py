"""Several balls at once, located: each keeps its identity while others cross or hide it.

Read `neighbors` first: `MultiTracker` tells the balls apart, and each that it follows is a `neighbor` with its markers
and its pose.
"""
