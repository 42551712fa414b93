"""What the page shows: a source is read and what was clicked is followed, in one thread that never waits for a viewer.

The newest picture with its answers lies in a box of one place; whoever looks takes a reference.
"""
