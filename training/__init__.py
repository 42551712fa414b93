"""What makes the weights of the network of discs, `matchset/image/disc_network/weights.npz`: `make weights`.

From balls that are rendered before photographs; no picture of a real ball is used. `__main__` is the one command, with
its seeds; `shipped` has the checksum of the weights that ship, how they came about, and times. Read `rendering` first;
`examples` reads patches around circles near the ball, by the package's own `polar_patch`. `train` learns from them with
PyTorch, as `augmentation` varies them; `pruning` leaves out what is `silent`.
"""
