"""Pictures of a flight: the frames of its video, and the report, one HTML file.

Read `report` (tables, and which plots it has), `parameter_table` and `plots` (Matplotlib), then `picture` (a frame of
the video) and `top_view` (its map). `gain_notes` says how gains were chosen, `measured_view` what a real flight saw.
`chain_frame` and `true_circle` compute the simulator's truth in the frames in which it is shown; `step_text` and
`colors` are shared with the live view.
"""
