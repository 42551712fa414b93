"""How long the pictures of a run took to compute.

`durations` counts them, however many they are: median, mean, 95 % and worst. A median alone hides the few frames
in which the whole picture was searched, which take much longer.
"""
