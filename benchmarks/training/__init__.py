"""How the weights of `matchset.image.disc_network` were learned: from balls that are rendered before photographs.

No picture of a real ball is used. In order:

    python -m benchmarks.training.photographs FOLDER
    python -m benchmarks.training.examples examples.npz --photographs FOLDER --seed 31 --scenes 14000
    python -m benchmarks.training.train examples.npz --out weights.npz --minutes 30

    python -m benchmarks.pruning examples.npz --weights weights.npz --out pruned.npz

The first fetches backgrounds from packages of Debian, where `apt-get` and `dpkg-deb` are; any folder of pictures does.
The last needs PyTorch, which nothing else here does. `--begin earlier.pt` goes on from a network that was learned
before, also from the package's own `weights.npz`. Several files of examples, of other seeds, can be given at once.

Read `scene` first: a ball (`ball`, `light`) or another shape (`other_shapes`), hidden by hands (`hands`) and other
things (`covers`), taken by a bad camera (`camera`); `layers` draws all of them. `examples` reads patches around circles
near the ball, by the package's own `polar_patch`. `train` learns from them, as `augmentation` varies them.
"""
