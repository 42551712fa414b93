"""What people use: one file per peer, each with the same four things.

`NAME`, for tables. `NEEDS`, what it is given in the first frame: "nothing", a "color" or a "circle" (see
`common.start.Start`). `Parameters`, each with the values that `python -m benchmarks.contest.search` tries
(`CHOICES`). And `follow`, one function: from the first frame to a function that is called with every frame.

None of these files imports matchset except `matchset.py` and `paper.py`, so that the memory and the start of a
peer are its own.
"""
