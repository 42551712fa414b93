"""Ellipses, rectangles, quadrilaterals and templates: accuracy and speed, beside OpenCV's ways to find them.

`cases` first: the shapes and their sequences. `trial` follows one; `accuracy`, `speed` and `tags` are the sections.
`contours` and `ellipses` are the peers, `search` finds the best parameters of EdgeDrawing's ellipses.
"""
