"""Interlaced video taken apart: each field a frame of its own time.

`interlace` tells from the pictures whether they are interlaced and which field comes first; `half_frames` makes two
half-frames of a frame; `field_reader` does both for a `Video`.
"""
