"""What a simulated vehicle makes of sticks: `speed_control.py` holds told speeds, `radio.py` rounds them.

The rigid body is that of `quadrotor.py` all the same; `chain_motion.py` asks for its setpoint each step.
"""
