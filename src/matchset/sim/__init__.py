"""A world to try it in: a room, a balloon, a camera, and an analog link, with exact truth."""
