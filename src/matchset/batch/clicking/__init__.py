"""A page for the videos in which it is doubtful what the ball is: one click each."""
