"""What a run shows of itself: the annotated video, a summary picture, an animation of a part, and which part.

`run_pictures` puts them together (`RunPictures`); `film` writes the video, reduced and of limited length where nobody
asked for it; `summary` draws the picture, `animation` the GIF or WebP file; `part` reads `--start` and `--end`.
"""
