"""Video files that are written: annotated films in a thread, and rendered clips with their truth.

Read `video_writer` first (`FilmWriter`); `codecs` says how each ending is packed and what an encoder is, `packing` how
hard. Three pack: `pyav_encoder`, `ffmpeg_encoder` (the program), `opencv_encoder`, which needs `noise_smoother` for
small films. `clip_export` writes a rendered clip to disk. What is drawn into the pictures is in `matchset.app.drawing`.
"""
