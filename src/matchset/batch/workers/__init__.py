"""Who does the work of a batch: processes of this computer, or a cluster of Dask.

`pool` is what both have in common, `processes` and `dask_cluster` are these, `worker` is what a process does at its
beginning.
"""
