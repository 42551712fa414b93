"""How the target's color follows the light.

`color_adaptation` learns a little from every well-fitted frame; `relighting` finds by how much the light of a whole
picture has changed, and takes a color along. Read `color_adaptation` first.
"""
