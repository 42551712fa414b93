"""Balls that the real clips do not show.

`pictures` draws balls into pictures with exact truth; `small` and `equal` follow them from a click. `stills` finds
balls in single pictures of a football field; `flights` measures how exactly simulated vehicles hold their places. Begin
with `pictures`.
"""
