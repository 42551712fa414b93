"""What is shown, kept: tables, a bag of ROS and the video of a stretch, in a new folder of `runs/`.

`recorder` begins and ends, `recording` is one folder, `stream_files`, `target_tables` and `bag` are its files.
"""
