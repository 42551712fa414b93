"""What helps where the ball is not found, or not known yet: why, in a picture and in words, and what to type next.

Read `explain` first: it is called when a run has found nothing or hardly anything, or a click was refused. `rejected`
looks for the best outline that was not believed, `why_picture` draws it beside the mask of the color, and
`next_command` chooses what to type. `choice` finds the frame and the circle that are most likely the ball,
`separation` the pixel of it to click at, and `candidate_tiles` shows what the colors of several circles cover.
All of them look at smaller copies of large pictures (`large_frames`).
"""
