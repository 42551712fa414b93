"""The server: page, socket, files, and who may see and command them.

It is bound to this computer unless it was told otherwise; then a token is needed.
"""
