"""Files of control: the keys of settings and of recordings as they were.

The key of a parameter is its name. `older_keys.py` has the keys that were other ones, by the struct that each is of,
and reads a parsed file that has them; `sim/toml_settings.py` and `flight/recording/reader.py` call it.
"""
