"""Where a batch keeps its results: folders, the manifest, the table of all, the page."""
