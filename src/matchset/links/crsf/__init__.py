"""The link through an ExpressLRS or Crossfire transmitter module on a serial port, to any flight controller.

Top down: `crsf_link.py` is the link, `radio_module.py` the thread that sends channels at a fixed rate and what it does
when the caller falls silent, `frame_timer.py` when a frame is due, `telemetry.py` what comes back, `sticks.py` a
command as channels, `parameters.py` the numbers and the URI. Frames and checksums are those of `links/crsf_frame.py`.
"""
