"""`matchset preflight`: what must be right before the motors of a real vehicle turn, one check after the other.

Read `sequence` first: the checks of one vehicle in their order, with the devices that they need. What each of them
must show is in pure functions: in `checks`, in `sticks` (radio) and in `moves` with `would_be` (a person moves the
vehicle). They return a `CheckOutcome` (`outcome`), their limits are in `parameters`. `command` is the command line,
with `options`; `run` stops at the first check that fails, prints and writes; `person` asks.
"""
