"""Checks before a first flight, each of which makes a `CheckOutcome`.

Read `link_checks` (what the link answers), then `picture_checks` (what single pictures show) and `sight_checks` (what
the loop sees of its ball while a person moves it).
"""
