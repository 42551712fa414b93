"""Which outline is the target's where a fit alone does not say.

Read `outline_choice`: of a ball the network of discs judges (`ball.judge`). `hypotheses` are shapes around an ambiguous
fit of any other family.
"""
