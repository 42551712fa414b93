"""Keys of files as they were: `older_keys` reads them."""
