"""Markers on a ball: found by color, placed to a fraction of a pixel.

Read `marker_tracker` first (what users call), then `marker_step` (one frame), `marker_fit` (one marker: Gauss-Newton
over the pixels), `marker_patch` (reads and weighs the pixels), `marker_shape` (the ellipse of a marker), `marker_color`
(how the colors of marker and ball differ). `marker_workspace` has all parameters, and the named fields that the kernels
share. `ball_colors` learns the colors of a ball and its marker from one picture.
"""
