"""A page for the videos in which it is doubtful what the ball is: one click each.

`clicker` says who can be asked, `page` is that page; its HTML lies in page/.
"""
