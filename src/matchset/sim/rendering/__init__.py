"""How things are drawn, each pixel by the share of it that they cover.

Read `renderer` (a balloon and what hides it) and `coverage` (its kernels) first, then `shutter` (fields, motion blur).
Three tasks are done in two ways, exact and fast: the room by `scene.scene.Scene` (kernels: `surface`) and
`background.FastScene`, a ball by `coverage.draw_sphere` and `draw_sphere_fast`, a lens by `lens_warp.ExactLensWarp` and
`FastLensWarp`. The exact ones make clips, the fast ones what cameras of a flight see; a test compares each pair.
"""
