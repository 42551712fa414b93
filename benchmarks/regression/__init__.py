"""Has a change made it worse on real footage, or slower as a user has it? `make bench-real`, kept in `kept.toml`.

`figures` says what a figure is, how much worse counts as noise and why, `kept` reads, writes and compares them,
`sections` names all that is measured: `footage`, `worse_copies`, `rendered`, `drawn` and the folder `balls` for
accuracy, with `raised` that counts exceptions, `times` for time, measured by `clock` in processes of its own on the
pictures of `pictures`. `page` writes `benchmarks/REAL.md`. Begin with `__main__` and `run`.
"""
