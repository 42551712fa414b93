"""Balls of three colors, one of them in two sizes, in one crowd: `python -m benchmarks.crowds.kinds`.

`table.py`: how such a crowd is composed; `__main__.py`: what is followed and detected after a click on each color.
"""
