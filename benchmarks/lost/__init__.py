"""What is lost when a disk is full or a program is killed: real commands, real processes, random moments.

Read `runs` (the commands, and the clip they read), `content` (how much of a file can be read), then `full_disk` and
`killed`, the two commands. What they must show is in docs/safety.md.
"""
