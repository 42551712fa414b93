"""Crowds that a physics engine moves and another renderer draws: pybullet and its TinyRenderer.

They report, and nothing is tuned on them: no code of `matchset.sim` draws them. Read `scenes.py`: who rolls where;
`world.py`: bodies; `camera.py`: pictures and truth; `surfaces.py`: what is painted on things; `sensor.py`: what a
camera makes of light; `clip.py`: `PhysicsCrowd`, frames kept in a file. Lengths are decimeters, which suits the engine:
its margins are made for bodies of such a size.
"""
