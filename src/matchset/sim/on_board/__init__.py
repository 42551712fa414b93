"""What a simulated vehicle makes of its radio by itself: `speed_control.py` holds told speeds, `radio.py` rounds sticks."""
