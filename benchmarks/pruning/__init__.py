"""Leaves out of the weights of the network of discs what answers to nothing: outputs that no example makes positive.

    python -m benchmarks.training.examples examples.npz --photographs FOLDER --seed 41 --scenes 4000
    python -m benchmarks.pruning examples.npz --out weights.npz

An output of a layer with the rectifier that is 0 for every ray of every example adds nothing, and a network that has
learned with a decay of its weights has many of them: of 4 times 96 outputs 202. Without them a look takes less time,
and all answers stay the same, bit for bit (docs/decisions/132-weights-without-silent-outputs.md).
"""
