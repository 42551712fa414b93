"""Several targets at once, for `track` and `locate`: `--all`, `--most`, several `--pick`, `--color NAME=FILE`, `--mot`.

Read `options` first, then `chosen` (which colors and clicks those mean), `run`, and `follow` (each frame through the
`MultiTracker`). `target_rows` is the table, `mot_file` the text for others' scorers, `painter` draws each identity in a
color of its own, `counts` says at the end what was found of each, `crowd` what is doubtful, and how many are left out.
`locate_run` and `poses` are the same for `locate`, `paths_picture` draws where they were.
"""
