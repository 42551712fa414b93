"""What can be shown: cameras, videos of this folder, the demo clip, the simulated chain, and what a person brings.

`found_sources` looks for them, `cameras` asks devices their names, `demo_clip` renders the clip, `opening` makes the
feed of a source, `source_selection` changes what is shown, `panel` is the menu; `uploads` keeps videos that a page
sends, `thumbnails` reads their first pictures.
"""
