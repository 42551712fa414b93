"""What only balls have: the network of discs as the judge of what is the ball, and where it is asked.

`judge` asks it. `estimator` finds a ball that is not where its outline was expected, by what it believes of it
(`belief`): `places` say where it may be, `log_odds` which disc it is, and `parameters` how all of them are set.
`disc_detector` takes the same steps in one picture that somebody asks for.
"""
