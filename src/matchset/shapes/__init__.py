"""What is looked for: families of convex outlines in the picture.

`shape` says what a family must have; `family_check` tests a user's own. `circle` is written out as an example;
`ellipse`, `quadrilateral`, and the families of a template (`polygon`, `convex`, made by `template`) share the kernel of
`linear_outline`; `rectangle` has its own. `orientation` finds how a template is turned; `described` has what shapes say
of themselves: box, dictionary, line. Read `shape`, `circle`, then `linear_outline`.
"""
