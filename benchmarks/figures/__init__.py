"""The figures of the results: what is drawn, and its data, kept beside each figure so that it can be drawn again.

Read `kept` first (`draw_kept` writes NAME.svg and NAME.json into `benchmarks/pictures`); `errors`, `times` and
`spreads` draw, each function from plain data to a Matplotlib figure in the style of `matchset.app.drawing.plot_style`.
`python -m benchmarks.figures` draws all figures again from their kept data, without measuring anything.
"""
