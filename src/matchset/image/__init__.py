"""Where pictures come from, and how much a pixel looks like the target.

`frame` is one picture; `video` opens a file (`video_files/`), a folder of pictures, a camera or a stream
(`camera_stream`, `streams/`), all through OpenCV (`capture`), or a recording of a robot (`bags/`). `color` is the
table from pixel value to score: `click_region` finds the pixels that a click means, with the ball-like circles of
`candidates` (`circle_score`), `color_learning` makes the table from them, `brightness` from gray values, and `light/`
lets it follow the light; `display/` shows pictures and colors in notebooks. Read `frame`, `color`, then
`color_learning`.
"""
