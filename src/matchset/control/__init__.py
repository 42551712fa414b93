"""Control: what to do about it."""
