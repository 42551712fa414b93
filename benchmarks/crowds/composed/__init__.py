"""Composed crowds: real balls, cut out of labelled clips, laid into other real pictures at known places.

Read `footage.py`: which balls and which backgrounds; `motion.py`: how they move; `picture.py`: how a ball is laid
into a picture; `coding.py`: how that is coded; `scenes.py`: the crowds. Seeds below 650 are for tuning; from 650 on
other balls and other backgrounds are used, for reports.
"""
