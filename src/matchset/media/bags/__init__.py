"""Pictures from recordings of robots: ROS 1 bags, ROS 2 bags and MCAP files.

`bag` chooses a topic and makes frames of its messages; `ros_image` reads a message, `rosbag_file` (package rosbags)
and `mcap_images` (package mcap) get the messages out of a file. Both packages are the extra `ros`.
"""
