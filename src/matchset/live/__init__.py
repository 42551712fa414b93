"""The live page: `matchset live` shows a camera, a video or a flight in a browser, and takes clicks there.

Read `feed` first: what can be shown, and what the parts of the page need of it. `vision` reads a live source, `targets`
follow what was clicked, `wire` holds the messages and how pictures reach a viewer, `web` serves page, socket and files,
and decides who may; `session` joins them, `page` is what the browser gets.
"""
