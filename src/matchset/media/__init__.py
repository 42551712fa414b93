"""Where pictures come from: cameras, streams, files, recordings of robots.

Read `video` first: it opens a file (`video_files/`), a folder of pictures, a camera or a stream (`camera_stream`,
`streams/`), all through OpenCV (`capture`), or a recording of a robot (`bags/`). `upright/` makes pixels square and
puts pictures upright, `damaged/` knows of pictures that were not decoded whole. `frame_list` and `exact_reader` read
a file again at any frame, by its content; `picture` decodes one, `closing` is what a `with` block needs.
"""
