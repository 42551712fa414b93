"""The next-but-one ball of a chain, half hidden behind the neighbor's.

`next_ball_tracker` is what a pilot calls: where it is, from a picture. `disc_search` holds the kernels that find it by
its color.
"""
