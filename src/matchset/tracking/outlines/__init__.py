"""Which outline is the target's where a fit alone does not say: `OutlineChoice`.

`hypotheses` are shapes around an ambiguous fit, `hypothesis_filter` weighs outlines against the frames before, and
`network_outlines` against what the network of discs sees.
"""
