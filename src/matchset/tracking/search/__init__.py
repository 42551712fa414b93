"""The search of a whole picture (Epstein & Feldman, Alg. 2).

Read `voting` first: a coarse grid of scores, and votes for centers. `peak_circles` makes circles of the votes, `blobs`
of places where the target's color prevails. `likely_circle` compares the fits of one picture, `disc_detector` asks the
network of discs, and `disc_search` finds the places where it is asked for a lost ball.
"""
