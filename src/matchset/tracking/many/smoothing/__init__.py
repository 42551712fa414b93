"""The best joint explanation of a whole video, which is read forward and backward.

Read `smoother` first, then `sweep` (what one reading sees), `joining` (segments in which both readings agree who is
followed), `motion_odds` (how well one goes on in another one), `chaining` (which are linked, decided for all together)
and `answers` (names, and what is where in each frame).
"""
