"""Video files as strangers have them: every frame that decodes, with a time that runs forward.

`video_file` reads a file with OpenCV. `file_clock` makes times of its time stamps, `container` looks into the file's
header for what OpenCV does not say, `pyav_capture` decodes with PyAV what OpenCV cannot,
`image_folder` reads a folder of pictures. Read them in this order.
"""
