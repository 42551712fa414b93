"""Commands for files and cameras, their tables, drawings and films; and what every command shares.

`matchset/cli.py` lists all commands; most are a function in the `command` module of a folder, with a class of options
in `options` (types that several share: `cli_options`); `warm` stands alone. The folders: `track` (track, learn, score,
demo, params), `detect` (one picture), `locate`, `calibrate`, `target` (what a person points at), `guidance` (what to
do where nothing is found), `backward` (before the click), `drawing` (pictures), `films` (video files), `pictures`
(what a run shows), `course` (paths, speeds), `timing` (what frames took), `adapters` (others' formats). The other
modules serve all: `exit_codes`, `run_folder` (where output is written), `disk` (its room), `progress` (the screen),
`tables` (CSV, JSON), `parameters_file`, `help_printer`.
"""
