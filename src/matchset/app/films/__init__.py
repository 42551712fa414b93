"""Video files that are written: annotated films in a thread, and rendered clips with their truth.

Read `video_writer` first (`Recorder`); `codecs` says how each ending is packed and what an encoder is. Three pack:
`pyav_encoder`, `ffmpeg_encoder` (the program), `opencv_encoder`. `clip_export` writes a rendered clip to disk. What
is drawn into the pictures is in `matchset.app.drawing`.
"""
