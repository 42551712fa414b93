"""matchset and what people use, on the same frames, from the same start.

`field` first: who takes part. `run` lets everybody follow a sequence; `accuracy`, `speed`, `real` and `tags` score
and time that, `start` with `peer_process` measures start-up and memory in processes of their own, `paper` repeats the
paper's Table 1 and Fig. 6, `summary` makes the README's table and its figure. `search` finds the best
parameters of the peers, on seeds that are not scored.
"""
