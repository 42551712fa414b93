"""A recorded video on the page: played, stepped through, and tracked as a whole in both directions.

`frame_list` of `matchset.media` knows every frame after one plain reading, `exact_reader` there reads any of them
again, `player` shows them.
`file_target` holds what was found in each frame, `tracking` fills it in the background by a `run` in each direction,
those of a `file_group`, which look alike, by an `alike_run`; `trials` refuses wrong clicks, `exports` writes tables
and films.
`file_feed` joins them, `panel` is what the page's buttons reach.
"""
