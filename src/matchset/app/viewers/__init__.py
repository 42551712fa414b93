"""The result of a run as one file for viewers of others: `--mcap` for Foxglove, `--rerun` for Rerun.

`options` is what is typed, `run` writes the files of a run, `viewed_frame` is a frame as both take it. Then
`foxglove_file` makes Foxglove's messages: `protobuf` encodes what `foxglove_definitions` says, `mcap_writer` stores it,
also for recordings of flights. `rerun_file` talks to Rerun's own package, which writes into a `piped_file`.
"""
