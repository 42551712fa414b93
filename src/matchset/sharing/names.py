"""Names and keys under which is shared: `checked_name`, `checked_key`."""

from matchset.numeric.arguments import check_kind

NOT_IN_A_NAME = "/*$?#%"  # format: characters with a meaning in keys of Zenoh and ROS
HIDDEN = "@"  # format: what begins so is not heard by who listens to all of Zenoh


def is_name(text: str) -> bool:
    """Whether a partner may be called so; what else comes under a key is not shown to anybody."""
    try:
        return bool(checked_name(text))
    except ValueError:
        return False


def checked_name(name: str) -> str:
    """Return a name under which is shared.

    Raises
    ------
    ValueError
        If it cannot be one.
    """
    check_kind("the name to share under", name, str)
    if not 0 < len(name) <= 64 or set(name) & set(NOT_IN_A_NAME) or not name.isprintable() or " " in name:
        wrong = f"1 to 64 characters without spaces and {' '.join(NOT_IN_A_NAME)}"
        raise ValueError(f"the name to share under has {wrong}, got {name!r:.80}")
    if name.startswith(HIDDEN):
        raise ValueError(f"the name to share under does not begin with {HIDDEN}, got {name!r}")
    return name


def checked_key(key: str) -> str:
    """Return a key under which is shared.

    Raises
    ------
    ValueError
        If it cannot be one.
    """
    check_kind("the key to share under", key, str)
    if not all(key.split("/")) or set(key) & set("*$?#@") or not key.isprintable():
        raise ValueError(f"the key to share under is like matchset or lab/chain, without * $ ? # @, got {key!r:.80}")
    return key
