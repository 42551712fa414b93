"""Half-frames of interlaced video against whole frames: `following` a rendered ball, `flying` a chain by it.

`python -m benchmarks.fields` prints both as tables.
"""
