"""The live page: `matchset live` shows a camera, a video or a flight in a browser, and takes clicks there.

Read `feed` first: what can be shown, and what the parts of the page need of it. Such feeds are made in `vision` (a
camera), `files` (a video) and `piloting` (a flight); `sources` lists what there is. `targets` follow what was clicked,
`camera` has a camera's panels, `record` records. `wire` holds the messages and how pictures reach a viewer, `web`
serves page, socket and files, and decides who may; `session` joins them, `page` is what the browser gets.
"""
