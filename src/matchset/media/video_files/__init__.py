"""Video files as strangers have them: every frame that decodes, with a time that runs forward, as it is to be seen.

`video_file` reads a file with OpenCV. `file_clock` makes times of its time stamps, `container` (with `mp4_boxes`,
`mp4_tracks`, `matroska_tracks`) looks into the file's header for what OpenCV does not say, `stream_choice` and
`file_view` say which stream is read and how it is seen, `pyav_capture` decodes with PyAV what OpenCV cannot,
`image_folder` reads a folder of pictures. Read them in this order.
"""
