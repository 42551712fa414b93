"""How fast, how exact and how honest tracking is, on rendered sequences.

`trial` first: the named sequences, and what a tracker makes of one. Then `accuracy`, `covariance`, `reacquisition` and
`false_locks` score it; `stopwatch` times contenders by turns, `contenders` says who they are, `speed`,
`startup` and `memory` use both.
"""
