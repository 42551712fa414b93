"""Answers in the types of other packages and devices, each imported only when it is asked for.

`mavlink_poses` sends poses to an autopilot. `supervision_detections` makes `supervision.Detections` of tracks, for that
package's annotators, zones and counters. A file here is for one package.
"""
