"""Links: how commands reach a vehicle, and how it answers.

Read `link.py` first: the contract of every link, six methods and a `with` block that lands, also on
a signal (`landing_signals.py`). `connect.py` opens the link that a URI names: `arduino/` for a radio on a serial port,
`crsf/` for an ExpressLRS or Crossfire module, `mavlink/` for ArduPilot or PX4, `tello/` (both on `datagrams.py`),
`simulated.py` for the simulated chain of vehicles, `simulated_link.py` for the radio of each, `picture_faults.py` for
the faults of their grabbers.
"""
