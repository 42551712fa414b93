"""Poses in meters: error, covariance and time, against the truth of rendered balls and markers.

`poses` first: it renders what the others measure. `range`, `methods`, `markers`, `covariance`, `prediction`,
`neighbors` and `speed` are a section each.
"""
