"""Stored pictures as they are to be looked at: square pixels, the right way up, from the deepest bits down to eight.

Read `orientation` first (the eight ways in which a picture may lie), then `square_pixels`, `view` (both of a source,
with what is to be said of it) and `header_view` (what OpenCV found in a header). `depth` scales 10 to 16 bits.
"""
