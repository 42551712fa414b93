"""flight_report."""
