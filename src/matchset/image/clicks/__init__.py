"""What a click means where nothing there has a closed outline.

`clear_disc` compares discs with the rings around them: `clearest_disc`.
"""
