"""Several computers: each tells the others what it sees, with the age and the uncertainty of all that it is told.

Read `messages` (what is sent), `clock` and `clock_offset` (how the clock of a partner stands to the own one) and
`partner` (what is known of one partner), `inbox` and `lines` (how much is taken and said), then `share`, which does it
over Zenoh; `connection` alone imports that. `ros2/` sends the same as ROS 2 does, `network_tables` to robots of FRC.
"""
