"""Pictures of results: what is drawn into frames, and sheets and plots of a whole run.

Read `annotate` first (outline, match-set and caption of a frame), with `text` (letters) below it; then `contact_sheet`
and `curves` (pictures of a whole run) and `plot_style` (the style of every plot; it and `curves` load Matplotlib).
`draw` has the public `draw` and `draw_pose`. Video files are written by `matchset.app.films`.
"""
