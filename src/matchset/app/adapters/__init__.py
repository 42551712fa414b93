"""Answers in the types of other packages, each imported only when it is asked for.

`supervision_detections` makes `supervision.Detections` of tracks, for that package's annotators, zones and counters.
A file here is for one package.
"""
