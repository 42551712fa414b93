"""What a click may mean.

Read `reading`: it weighs the discs that the network sees there and the region that grew in color.
"""
