"""How fast, how exact and how honest tracking is, on rendered sequences and real clips.

`trial` first: the named sequences, and what a tracker makes of one. Then `accuracy`, `covariance`, `reacquisition`,
`false_locks` and `real` score it; `stopwatch` times contenders by turns, `contenders` says who they are, `speed`,
`startup` and `memory` use both. `pictures` draws.
"""
