"""Several targets at once: each keeps its identity while others cross or hide it.

Read `multi_tracker` first. `followed` is one target with its tracker, `motion_bank` how all of them move, `sightings`
what is seen in a frame, `association` who is where, `strip_search` finds those that nobody follows yet.
"""
