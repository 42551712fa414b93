"""Links: how the drone hears it."""
