"""A long video in stretches that overlap, and one table of them."""
