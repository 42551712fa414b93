"""Balls of three colors, two sizes of one of them, in one crowd: `Table`, its score, and `python -m ...crowds.kinds`."""
