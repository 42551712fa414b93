"""Real footage: how well matchset follows, finds and refuses on clips that a camera took.

`clips` first: which clips there are, and their truth. `starts` says where a clip is clicked, `following` gives every
frame to all trackers at once. `scores`, `detection` and `foreign` make figures of that, `measure` and `section` put
them together. `python -m benchmarks.real.failures CLIP` shows where one run failed, what the tracker said, and by
`gates` which rules refuse the ball at its true place.

`copies` makes worse copies of the clips, and measures on those.

`labels/NAME.csv` is the truth of a clip. `labelling`, and `streak` where the ball is smeared, fitted it from circles in
`labels/by_hand/NAME.csv` without matchset's own edges, and every row was looked at. The clips themselves are not in the
repository.
"""
