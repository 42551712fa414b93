"""Who does the work of a batch: processes of this computer, or a cluster of Dask."""
