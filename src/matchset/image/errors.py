"""What a broken device raises."""


class LinkError(ConnectionError):
    """A device (camera, stream, radio) cannot be opened, or went away while it was in use."""
