"""What a person points at: a click, a candidate, a color or a drawn shape, from the command line to a tracker's start.

Read `target_options` (color and start from the options), then `frame_picker` (the frame that was meant). `shape_option`
makes the family that `--shape` names.
"""
