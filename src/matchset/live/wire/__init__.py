"""What goes over the WebSocket: messages, pictures, and how many of them may be on their way.

Down go binary packets of a header, JSON and a JPEG; up goes JSON.
"""
