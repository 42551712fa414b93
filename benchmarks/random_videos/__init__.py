"""Videos drawn by chance, of any ball before any photograph: whether what holds on labelled clips holds elsewhere.

`motion` says where camera and ball are, `video` renders a video with its truth, `following` scores it, and
`python -m benchmarks.random_videos FOLDER` lets matchset and the recipes of tutorials follow many of them.
"""
