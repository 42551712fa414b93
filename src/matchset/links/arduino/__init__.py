"""arduino."""
