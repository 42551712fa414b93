"""Clicks of which is known what was meant: whether `ColorModel.pick` takes it, or offers it.

`scenes` draws pictures that mislead a click, `pictures` adds random videos and labelled clips, `judging` says what a
pick took and offered, and `python -m benchmarks.clicks` prints a table.
"""
