"""One picture: from a rough state to a fitted shape, and whether to believe it.

Read `fitter` first, which is what other folders use; then `local_fit`, the loop; and its stages `prior`, `match_set`
(Epstein & Feldman, Eq. 1-4), `robust_fit`, `fit_quality` and `validation`. `evidence` weighs all figures of a fit
together where a search asks whether it is the target; `soft_region` is that of a blurred one. `color_adapting` lets the
color follow the light. `workspace` names everything that the compiled code reads and writes.
"""
