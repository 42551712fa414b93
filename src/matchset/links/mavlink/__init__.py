"""MAVLink 2 of the few messages that a follower needs, without a dependency.

Top down: `mavlink_link.py` is the link, `client.py` the dialog with the autopilot, `telemetry.py` what it said,
`autopilots.py` its modes, `address.py` the URI, `ports.py` UDP and the serial port. Below them `packet.py` makes
packets and finds them in a stream of bytes, `messages.py` is the table of all messages, `message.py` what one consists
of, `checksum.py` the CRC. For those who want poses at the autopilot and not sticks: `estimates.py`, and `axes.py`.
"""
