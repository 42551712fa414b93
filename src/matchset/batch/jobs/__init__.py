"""One video of a batch: which there are, what is followed in it, and what a worker does with it."""
