"""How others find balls after one click, without matchset: what peers are fed with that bring their own finder.

Read `finder.py`, what a finder is and what it has found; then `recipe.py`, `edges.py` and `spots.py`. `tuning.py` finds
the best parameters of each on seeds that are not reported.
"""
