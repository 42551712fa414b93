"""A long video in stretches that overlap, and one table of them.

`parts` cuts and waits for the last one, `opening` lets `track` read a stretch, `stretch_work` is what a worker does
with it, `joining` puts the tables together: by their pictures, and targets by where they are.
"""
