"""One video of a batch: which there are, what is followed in it, and what a worker does with it.

Read `job` first: what a worker is told, and what it answers. `videos` lists them, `target`, `clicks` and `choice` say
what is followed, `video_options` what `track` or `locate` is told. `work` does it, and `identity` and `counts` say of
which file, by which program, and how much was found.
"""
