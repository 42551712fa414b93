"""Real footage: how well matchset follows, finds and refuses on clips that a camera took.

`clips` first: which clips there are, and their truth. `starts` says where a clip is clicked, `following` gives every
frame to all trackers at once. `scores`, `detection` and `foreign` make figures of that, `section` puts them together;
`python -m benchmarks.real.failures CLIP` shows where one run failed, and what the tracker said.

`labels/NAME.csv` is the truth of a clip, fitted by `labelling` from the circles in `labels/by_hand/NAME.csv`, without
matchset's own edges; every row was looked at. The clips themselves are not in the repository.
"""
