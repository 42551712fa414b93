"""Which pictures of a video are wrong because something of it is missing.

`damage` follows the errors of a decoder from one picture to the next. What a decoder of H.264 does not report, pictures
that are missing as a whole, `frame_numbers` sees in the headers of the others.
"""
