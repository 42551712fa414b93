"""Where it is, in meters."""
