"""The evidence: what matchset costs and how exact it is, measured in one run by `python -m benchmarks`."""
