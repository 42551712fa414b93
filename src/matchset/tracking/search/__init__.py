"""The search of a whole picture (Epstein & Feldman, Alg. 2).

Read `voting` first: a coarse grid of scores, and votes for centers. `peak_circles` makes circles of the votes, `blobs`
of places where the target's color prevails. Where the network of discs is asked stands in `matchset.tracking.ball`.
"""
