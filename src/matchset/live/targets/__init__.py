"""What was clicked and is followed since: its messages, the tracker behind it, and its place in meters.

`panel` takes the messages, `waiting` keeps them; `followed_targets` has all of a camera, which `target_maker` makes
beside its loop. `target` follows one, `target_localizer` places it; `groups` knows which look alike, `alike` follows
those together. `clicks` tells what became of each click.
"""
