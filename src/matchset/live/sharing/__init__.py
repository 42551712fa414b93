"""What is shown, shared with other computers, and what these see, on the page.

`shared_page` publishes and reads, `state` is what the page shows of it.
"""
