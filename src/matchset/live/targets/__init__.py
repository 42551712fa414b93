"""What was clicked and is followed since: its messages, the tracker behind it, and its place in meters.

`panel` takes the messages, `target` follows, `clicks` tells what became of each click.
"""
