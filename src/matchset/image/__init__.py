"""One picture, and how much a pixel looks like the target.

Read `frame` (one picture), `color`, then `color_learning`. A color is a table from pixel value to score: `clicks` reads
a click, `click_region` finds its pixels, with the ball-like circles of `candidates` (`circle_score`), `color_learning`
makes the table from them, `brightness` from gray values, and `light` lets it follow the light. `disc_network` says how
much a patch looks like a ball. `files` reads and writes settings, `display` shows pictures and colors in notebooks.
"""
