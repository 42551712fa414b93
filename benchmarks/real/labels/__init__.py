"""Labels of real clips, one file for each: the consensus of two or three labellings (`consensus.py`).

`fitted` are those of the offline fit, which began at `by_hand`. `blind` and `blind_second` have the same rows labelled
once more by persons who knew neither the labels nor an answer of a tracker, from crops that do not tell the center or
the size; `again` in them some of those a second time. `agreement.py` compares them.
"""
