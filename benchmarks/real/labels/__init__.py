"""Labels of real clips, one file for each; `by_hand` has what the offline fit began at.

`blind` has the same rows labelled once more by somebody who knew neither the labels nor an answer of a tracker, from
crops that do not tell the center or the size; `blind/again` some of them a second time. `agreement.py` compares them.
"""
