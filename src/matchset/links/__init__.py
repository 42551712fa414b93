"""Links: how commands reach a vehicle, and how it answers.

Read `link.py` first: the contract of every link, six methods and a `with` block that lands, also on
a signal (`landing_signals.py`). `connect.py` opens the link that a URI names: `arduino/` for a radio on a serial port,
`crsf/` for an ExpressLRS or Crossfire module, `mavlink/` for ArduPilot or PX4, `tello/` (both on `datagrams.py`),
`simulated.py` for the simulated chain of vehicles, with `picture_faults.py` of their grabbers. `serial_port.py` and
`crsf_frame.py` serve several of them.
"""
