"""Where in a picture a ball may be: where something has moved, and where its color stands out.

Read `changes` first, then `color_places`; what runs over all pixels is compiled, in `changes_kernel` and
`color_places_kernel`. Nothing here knows of tracks.
"""
