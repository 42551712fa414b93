"""The command line, and everything that reads files, prints, draws or waits for a person.

Read `cli` first: it lists the commands; each is a function in the `command` module of its folder, and its options are
a class (`cli_options`). The folders: `track` (track, learn, score, demo, params), `locate`, `calibrate`, `guidance`
(what to do where nothing is found), `drawing` (pictures), `films` (video files), `pictures` (what a run shows),
`flight` (fly, simulate), `flight_report`, `recording` (replay), `radio`, and `gym` (an environment for Gymnasium). The
other modules serve all of them: `exit_codes`, `run_folder` (where output is written), `progress` (the screen), `tables`
(CSV, JSON), `closing` (files that a `with` block closes), `timing` (what the frames took).
"""
