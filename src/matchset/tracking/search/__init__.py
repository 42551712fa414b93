"""The search of a whole picture (Epstein & Feldman, Alg. 2).

Read `voting` first: a coarse grid of scores, and votes for centers. `peak_circles` makes circles of the votes, `blobs`
of places where the target's color prevails, and `prominence` tells whether the target is alone with its color. Where no
outline is found, `color_disc` looks for the target's color about a prediction, and `template` for its looks.
"""
