"""`matchset simulate`: many simulated flights under changed conditions, and a verdict.

`command.py` is the command and flies them, in processes of their own; `table.py` compares their scores with limits.
"""
