"""What a broken device raises, what an address without a stream, and what a missing file."""


class LinkError(ConnectionError):
    """A device (camera, stream, radio) cannot be opened, or went away while it was in use."""


class NoStreamError(LinkError, ValueError):
    """An address answers, but not with pictures: a wrong address, sooner than a broken device."""


class MissingFileError(FileNotFoundError, ValueError):
    """There is no file of the name that a caller gave: a wrong value, and for Python a file that is not found."""
