"""``python -m matchset``: the command line where the script `matchset` is not on the path, or another Python's is.

It is the same command; `matchset --help` lists what there is.
"""

from matchset.cli import main

if __name__ == "__main__":
    main()
