"""Compiled code and the mathematics that has nothing to do with images.

Read `jit` first (how functions are compiled), then `record` (named fields in a block of floats, for kernels and for
Python). `linalg` has small matrices, `rotation` rotation matrices and vectors, `kalman` the steps of a Kalman filter.
`kept_code` keeps machine code on disk, under `code_identity`; `compiling` says when there is none. `arguments` checks
what a caller hands in, `words` writes numbers for people.
"""
