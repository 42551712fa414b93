"""Files of one piece: written whole or not at all, and read no further than a limit.

Read `whole_file` (`write_whole`) first, then `limits` (`InputLimits`: what is refused), `reading` and
`color_file`.
What is in a file may come from a stranger: nothing is decoded before its size is known.
"""
