"""The room, furnished from a seed.

Read `scene` first: it renders a room from anywhere. `room` builds walls, floor, window and posters and chooses the
furniture that `furniture` makes; `clutter` hangs up blue things that may mislead a tracker. `textures` are the pictures
on all of them.
"""
