"""Would the tests notice? `python -m benchmarks.mutants`, or `make mutants`, breaks one line at a time and runs them.

The mutants are lists in `*.toml`, written by hand: a file, the tests that are to notice, and for each mutant a fragment
that occurs once in the file and what replaces it. `mutant` reads and applies them, `run` tests one of them in a copy of
the repository, `table` writes docs/mutants.md. Results are kept in build/mutants/results.jsonl: a run that was broken
off goes on, and what has not changed is not run again.
"""
