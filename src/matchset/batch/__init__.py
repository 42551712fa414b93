"""Many videos, by several processes or computers: `matchset batch`.

`jobs/` is what is done with one video, `workers/` who does it, `results/` where it is kept, `split/` long videos in
stretches, `clicking/` the page on which a person clicks where it is doubtful what the ball is.
"""
