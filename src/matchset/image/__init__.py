"""One picture, and how much a pixel looks like the target.

`frame` is one picture. `color` is the
table from pixel value to score: `click_region` finds the pixels that a click means, with the ball-like circles of
`candidates` (`circle_score`), `color_learning` makes the table from them, `brightness` from gray values, and `light/`
lets it follow the light; `display/` shows pictures and colors in notebooks. Read `frame`, `color`, then
`color_learning`.
"""
