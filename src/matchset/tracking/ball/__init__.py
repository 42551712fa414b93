"""What only balls have: the network of discs as the judge of what is the ball, and where it is asked.

`judge` asks it and adds what is known; `disc_search` says where something stands out; `lost_ball` finds a ball that was
lost, and `distractors` remembers what is not the ball. `disc_detector` is for one picture that somebody asks for.
"""
