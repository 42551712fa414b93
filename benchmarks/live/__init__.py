"""Measurements of the live page in a real browser.

`curves` takes the time that the browser needs to draw the curves of 30 s at 500 samples/s, ours and those of uPlot.
"""
