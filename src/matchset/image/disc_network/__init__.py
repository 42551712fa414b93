"""Where the outline of a ball is around a circle, and whether one is there: a small convolutional network.

`polar_patch` reads the picture along rays from a circle's center; `network` says what they show. The weights,
`weights.npz`, are learned from rendered balls alone by `training` (docs/decisions/114).
"""
