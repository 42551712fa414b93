"""What several peers share: what they are told, the color they learn, contours, regions.

`start` first: what a peer is given and what it gives back. `target_color` learns the color from the first frame's
disc, `contour` makes a circle of a mask, `region` looks around the last circle only, `resident_memory` asks the
process for its size.
"""
