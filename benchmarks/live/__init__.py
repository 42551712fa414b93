"""Measurements of the live page in a real browser.

`curves` takes the time that the browser needs to draw the curves of 30 s at 500 samples/s, ours and those of uPlot.
`section` is `python -m benchmarks --only live`: `server` runs the page's server with pictures that carry the time of
their capture (`bar_code`), `screen` reads it back in the browser, `clients` are viewers without one and a slow link,
`day` passes a day's worth of pictures through the server's parts.
"""
