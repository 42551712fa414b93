"""Real clips as worse cameras would have taken them: smaller, coded harder, with fewer pictures, in light that jumps.

`copy` makes them from the clips of `--data DIR`, with their truth; `section` follows and seeks the ball in them. Most
strangers' videos are worse than ours, and what holds on ours need not hold on those.
"""
