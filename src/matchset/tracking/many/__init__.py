"""Several targets at once: each keeps its identity while others cross or hide it.

Read `multi_tracker` first, then `tracklet`: what is followed without a gap, and whose it may be. `observer` says what
is seen in a frame, `linking` decides whose it is, `motion_bank` filters how all of them move. `sightings`,
`searching/` and `field_timing` are what the observer uses. `smoothing/` explains whole files, forward and backward.
"""
