"""`matchset simulate`: many simulated flights under changed conditions, and a verdict.

Read `command` first, then `variation` (which flights) and `flights` (each in a process of its own). `table` compares
their scores with limits, `picture` draws them.
"""
