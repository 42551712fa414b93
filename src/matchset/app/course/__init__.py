"""The course of a target over a whole run: its numbers in a log, as curves, and as a table for programs.

Read `log` first (`ShapeLog`: center and size of each frame; `Course`, what curves are drawn from), then `speed` (the
slope of what was measured) and `figure` (the curves; it loads Matplotlib). `table` is the public `ms.table`.
"""
