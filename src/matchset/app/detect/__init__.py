"""The command `matchset detect`: what is in one picture. `command`, its `options`, and `run`."""
