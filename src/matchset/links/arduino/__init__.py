"""The link through an Arduino with a radio, which runs ``firmware/syma_transmitter``.

Top down: `arduino_link.py` is the link, `protocol.py` the dialog with the firmware, `channels.py` turns a command into
the channels of a frame, `messages.py` has the firmware's own messages. Frames with their checksums and the port are
in `crsf_frame.py` and `serial_port.py` of `matchset.links`.
"""
