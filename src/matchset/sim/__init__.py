"""A simulated world: vehicles that fly in a room, and the pictures of their cameras, from a seed.

Read `vehicle` (what a vehicle is like, with ``vehicle.toml``), `quadrotor` (its equations of motion) and `rope` first,
then `world` (a chain of vehicles; `chain_motion` holds its kernels). `cameras` draws what they see: `vehicle_camera`
one field of one camera with `airframe` for the vehicles, `analog_link` (its kernels: `line_filter`) what a transmitter
makes of it. `toml_settings` reads settings. Folders: `rendering` (how things are drawn), `scene` (the room), `clips`
(sequences of frames with their truth, for tests and benchmarks).
"""
