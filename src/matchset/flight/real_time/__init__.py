"""What keeps the loop of a flight in time, so that a vehicle never waits for a command.

Read `rehearsal` (everything that a first step does is done once before arming), `memory` (the garbage collector's
pauses), `priority` (of the loop over all else) and `background` (what is shown and written in threads of their own).
"""
