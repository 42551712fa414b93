"""The command `matchset detect`: what is in one picture.

Read `command` first, then its `options`, and `run`: it learns the color, finds all like it, and says what is left out.
"""
