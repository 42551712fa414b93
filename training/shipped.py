"""Which weights the package ships: `SHIPPED`, compared with a file's `checksum`.

They were learned in steps, each from the weights of the one before, with one core and by the clock, before
`make weights` was one command: they cannot be made again to the byte. Which seeds the scenes of a step had was not
written down; docs/log/network.md has what each was better at. In its order, with the commit that shipped it:

- 3ea7b7c1, c1c525bf: 64 numbers of a ray; about 105,000 scenes in all, 72 minutes.
- afb3cd8b: 96 numbers of a ray, begun with those before; 56,000 new scenes, 55 minutes; then balls with spots and fewer
  rings, 30,000 new scenes of 44,000, 24 minutes.
- 643a1822: 45,000 new scenes, of which 40 % are the last picture of a coded video, 65 minutes; then fingers around the
  rim and scenes that are smeared as a whole, 17,000 new scenes of 32,000, 28 minutes.
- 4b1b1240: the colors of the ball known from an earlier picture, 24,000 new scenes, 30 minutes, then 32 at half rate.
- 348e55f2: without the 202 outputs that never answer (docs/decisions/132-weights-without-silent-outputs.md).

`make weights` takes half an hour of one core: 4 minutes for 14,000 scenes (seed 31), 26 for 10,000 steps (seed 0), 1 to
prune by 4,000 scenes (seed 41). With 2,500 steps it took 12.4 minutes, before 239 photographs (2026-11-28, PyTorch
2.14.1); on 500 other scenes (seed 43) their loss is -6.37, that of the shipped weights, which saw twenty times as many
scenes, -7.36.

New weights ship when they are better on the labelled clips (`python -m benchmarks --only real`), with their checksum
here and their line above; those that `make weights` makes from nothing are where to begin (`--begin` goes on).
"""

import hashlib
from pathlib import Path

SHIPPED = "2c5e905972f92c69e495da88a0442adc75eb83f2942a92a4ade43cf483c2e989"
"""SHA-256 of `matchset/image/disc_network/weights.npz`."""


def checksum(path: Path) -> str:
    """SHA-256 of a file, in hexadecimal digits."""
    return hashlib.sha256(path.read_bytes()).hexdigest()
