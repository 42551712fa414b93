"""How camera and marker are mounted, as far as it is told and as far as a flight shows it.

`camera_mount.py` turns a pose from the camera to its vehicle, and learns the pitch at which the camera is mounted from
the mean elevation of the neighbor's marker. `mount_fit.py` finds the mount from balls at measured places: what only
`matchset calibrate --mount` can tell. docs/flight.md says what that is.
"""
