"""The evidence: `python -m benchmarks`, or `make bench`, measures everything and writes RESULTS.md.

`__main__` lists the sections; `results` is what a section returns, `report` and `readme` write it down, `options`,
`machine` and `workers` are what a run knows of itself. `guard` holds a change against limits.toml in a minute. The
sections are in `tracking`, `real`, `contest`, `shapes`, `localization` and `flight`; the peers in `peers`, their parts
in `common`; `figures` draws.
"""
