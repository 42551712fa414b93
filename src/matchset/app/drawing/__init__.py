"""Pictures and videos: what is drawn into frames, and how it is written.

Read `annotate` first (outline, match-set and caption of a frame), with `text` (letters) below it; then `video_writer`
(the annotated video, in a thread), `contact_sheet` and `curves` (pictures of a whole run), `plot_style` (the style of
every plot; it and `curves` load Matplotlib), and `clip_export` (a rendered clip with its truth, to disk). `draw`
has the public `draw` and `draw_pose`.
"""
