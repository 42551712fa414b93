"""A foreign flight controller flies a follower: Betaflight's own source, built for this computer, in lock-step.

Read `fly.py` first, the command: seeds, cases, a table. `world.py` couples rope, camera and the rigid body of
`airframe.py` (none of the simulator's physics) with the program that `sitl.py` runs; `sticks.py` are the links to it,
by UDP and by CRSF. `clock.c` makes the program's time that of the world; `.ci/setup-betaflight` builds both,
`settings.txt` is typed into its command line. Betaflight is licensed under the GPL: it is a program of its own, no part
of matchset.
"""
