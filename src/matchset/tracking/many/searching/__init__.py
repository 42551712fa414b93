"""What nobody follows yet is searched for in every frame that is worth it.

Read `searches` first: which search is due. `disc_search` finds balls in a whole picture, where their color stands out
and `unexplained` counts more of it than the balls that are known have; `strip_search` finds other shapes in strips.
"""
