"""Photographs and drawings with several equal discs, labelled: how many of them `detect` finds after one click.

`NAME.csv`: where the discs are; `README.md`: how they were labelled; `measure.py`: the figures.
"""
