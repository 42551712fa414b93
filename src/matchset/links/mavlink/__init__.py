"""MAVLink 2 of the few messages that a follower needs, without a dependency.

Bottom up: `checksum.py` is the CRC, `message.py` what a message consists of, `messages.py` the table of all messages,
`packet.py` makes packets and finds them in a stream of bytes.
"""
