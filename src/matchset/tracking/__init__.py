"""Over time: the paper's tracker.

Read `tracker` first: `Tracker.update` is Alg. 1. It uses `track_step` (Alg. 3), whose `compiled_step` joins the fit and
`motion` (predict, gate, correct); `outlines` where a fit is ambiguous; `detector` with the folder `search` (Alg. 2)
where the shape is searched, and `ball` where a ball was lost; `initialization` where it is given.
`parameters` has every number that decides something, `track` the answers.
"""
