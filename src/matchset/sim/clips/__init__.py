"""Sequences of frames with their exact truth, for tests, benchmarks and demonstrations.

Read `clip` first: a balloon on a smooth path (`trajectory`), its truth in px (`truth`), what hides it (`occluder`).
`balloon` is what is drawn. `ball_flight_clip` puts it on a path of one's own before a camera with a lens, its truth is
in meters; `multi_ball_clip` has several; `shape_clip` a flat convex shape.
"""
