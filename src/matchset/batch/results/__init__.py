"""Where a batch keeps its results: folders, the manifest, the table of all, the page.

`store` writes files to a folder or a URL, `lock` keeps a second batch out, `manifest` notes what has ended. At the end
`report` writes a row for each video, `all_rows` all their rows, `page` and `worst_picture` what a person looks at.
"""
