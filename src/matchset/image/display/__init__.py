"""What a notebook shows of pictures and colors, as PNG.

`png` encodes a picture; `swatch` paints which colors, or which gray levels, a color model takes for the target.
Nothing here is used by the tracking loop.
"""
