"""Pieces that several peers share; no peer itself."""
