"""Settings and recordings as they were before keys became the names of parameters: the table of names, backward."""

from typing import Any

from matchset.control.files.older_keys import OLDER_KEYS, kind_of


def with_older_keys(table: Any, kind: type | None) -> Any:
    """Write a table with the keys that it had before."""
    if not isinstance(table, dict):
        return table
    before = {new: old for old, new in OLDER_KEYS.get("" if kind is None else kind.__name__, {}).items()}
    return {before.get(name, name): with_older_keys(value, kind_of(name, kind)) for name, value in table.items()}
