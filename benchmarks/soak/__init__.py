"""A soak: `make soak`, or `python -m benchmarks.soak --hours 1`, flies for an hour of simulated time under faults.

Read `plan` first (what happens in a flight is decided by the seed and the flight's number), then `invariants` (what
must hold at every step, pure functions), `resources` (memory, file handles, threads) and `fly` (one flight). `faults`
are those of cameras, air and disk; `clicked` is a tracker and a localizer beside the pilots, restarted by random
clicks; `replayed` compares a recording with its replay; `report` is the table. The page is docs/soak.md.
"""
