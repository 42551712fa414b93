"""The commands `matchset track`, `learn`, `score`, `demo` and `params`.

Read `command` and its `options` first, then `run` (of `track`), `loop` (each frame through the tracker), `rows` (the
table) and `outputs` (files and stdout). What to track comes from `matchset.app.target`. `learn_command` looks for
ball-like circles and shows them by `grid_picture`; `score` compares a table with the truth; `demo` does all of it on a
rendered clip.
"""
