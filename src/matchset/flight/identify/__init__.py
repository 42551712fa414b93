"""`matchset identify`: what a controller must know of a vehicle, found in seconds of flight before a ball that hangs.

Read `estimate` first: a pure function from a `StickLog` (`flight_log`) to values with standard deviations, by
`vehicle_model`, the vehicle's answer to its sticks, and `whitening`, the noise of what it leaves. `unknowns` has what
is known before. `parameters` makes of a flight one that is flown carefully, its sticks shaken by
`matchset.flight.chain.excitation`. `verdict` says what was found and what not, and why; `vehicle_file` writes it as
settings that `matchset fly --config` reads; `run` flies, and `command` is the command line.
"""
