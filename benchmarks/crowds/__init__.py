"""Crowds of equal balls with exact truth, and who keeps which name.

Read `crowd.py`, then `scenes.py`, `juggling.py` and `pair.py`: what is rendered; `composed/`: real balls in other real
pictures; `physics/`: another renderer, with a physics engine, only to report. `cases.py`: what is detected in it;
`followers.py` and `peers/`: who follows it; `score.py`: MOTA as a user counts, HOTA, IDF1, switches; `rows.py`,
`page.py` and `__main__.py`: the table. `stills/`: what is detected in single pictures.
"""
