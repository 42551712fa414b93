"""Recall and precision of `detect` in labelled stills: `python -m benchmarks.crowds.stills`."""

import typer

from benchmarks.crowds.stills.measure import main

typer.run(main)
