"""`matchset preflight`: what must be right before the motors of a real vehicle turn, one check after the other.

Read `sequence` first: the checks of one vehicle in their order, with the devices that they need. What each of them
must show is in pure functions: `picture_checks` (camera, exposure), `link_checks` and `sticks` (radio),
`sight_checks` (ball, pose, times), `moves` with `would_be` (a person moves the vehicle). They return an `Outcome`,
their limits are in `parameters`. `command` has the options, `run` stops at the first check that fails, prints and
writes; `person` asks.
"""
