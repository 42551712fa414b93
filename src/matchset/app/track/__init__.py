"""The commands `matchset track`, `learn`, `score`, `demo` and `params`.

Read `command` first (options, and the run of `track`), then `target_options` and `shape_option` (what to track), `loop`
(each frame through the tracker), `rows` (the table) and `outputs` (files and stdout). `learn_command` uses
`frame_picker`, `candidates` (ball-like circles) and `grid_picture`; `score` compares a table with the truth; `demo`
does all of it on a rendered clip.
"""
