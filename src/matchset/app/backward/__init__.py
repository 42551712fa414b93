"""From a click backward to the beginning of a file: what is followed forward from the click was there before it, too.

Read `mirrored` first (a tracker that is shown the frames in reverse), then `follow_back` (the frames of a file from the
click to the first, a few of them in memory at a time), `known_answers` (which hands the answers out in order of time)
and `before_click` (all of it, as the options of a command ask for it).
"""
