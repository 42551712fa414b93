"""How long a pose takes from one program to another, and what loss does: `python -m benchmarks.sharing`.

`__main__` prints the table; `sender` is the partner, a process of its own.
"""
