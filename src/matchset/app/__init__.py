"""Commands for files and cameras, their tables, drawings and films; and what every command shares.

`matchset/cli.py` lists all commands; each is a function in the `command` module of its folder, and its options are a
class in `options` (types that several share: `cli_options`). The folders: `track` (track, learn, score, demo, params),
`locate`, `calibrate`, `guidance` (what to do where nothing is found), `backward` (before the click), `drawing`
(pictures), `films` (video files), `pictures` (what a run shows), `course` (paths, speeds, tables), `adapters` (others'
formats). The other modules serve all of them: `exit_codes`, `run_folder` (where output is written), `progress` (the
screen), `tables` (CSV, JSON), `timing` (what the frames took).
"""
