"""What the pixels inside a fit and around it look like in this one picture.

`local_color` learns the colors of both, and says of any pixel which of the two it belongs to: `learn_local_color`. It
knows what a click did not teach: a shaded rim, a pale cap, another light, and the background that is there now.
"""
