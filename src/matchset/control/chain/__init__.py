"""What a follower makes of more than its neighbor, for long chains.

`next_but_one.py` lets it hold its place beside two balls: its neighbor's, and that of the vehicle which its neighbor
follows; `slow_part.py` separates their slow motion. `gain_schedule.py` and `long_chain.py` choose the gains.
"""
