"""A flight under a page: who commands, and what the silence of that page does.

The server holds the vehicle's safety, not the page: everything here is pure, and times are given.
"""
