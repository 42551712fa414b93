"""A batch on many machines, simulated from what was measured on one.

Read `simulate.py`: the model, event by event, with nothing but `heapq`; `basis.py`: the measured times and sizes in
it; `predicted.py`: two workers, simulated and real; `many.py`: 1 to 1,000 machines, and what `--split` does.
"""
