"""Real footage: how well matchset follows, finds and refuses on clips that a camera took.

`clips` first: which clips there are, and their truth. `starts` says where a clip is clicked, `following` gives every
frame to all trackers at once. `scores`, `detection` and `foreign` make figures of that, `section` puts them together;
`python -m benchmarks.real.failures CLIP` shows where one run failed, and what the tracker said.
"""
