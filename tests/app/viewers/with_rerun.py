"""The command line in an environment that has Rerun's package: that of .viewers stands behind all others.

Started as `python with_rerun.py FOLDER WORDS...`, FOLDER being where those packages are.
"""

import sys

if __name__ == "__main__":
    sys.path.append(sys.argv.pop(1))
    from matchset.cli import main

    main()
