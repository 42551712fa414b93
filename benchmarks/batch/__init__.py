"""What `matchset batch` costs and how it grows: measured here with one and two workers, simulated for many.

Read `videos.py`: what is rendered; `speed.py`, `overhead.py`, `tasks.py`, `split.py`, `killed.py`: what is measured;
`simulation/`: the model, how well it predicts two workers, and what it says of many; `page.py` and `__main__.py`: the
page.
"""
