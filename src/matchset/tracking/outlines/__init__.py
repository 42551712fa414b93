"""Which outline is the target's where a fit alone does not say: `OutlineChoice`.

`hypotheses` are shapes around an ambiguous fit, and `network_outlines` the discs that the network of discs sees.
"""
