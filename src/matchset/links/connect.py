"""From a URI to a link."""

from matchset.links.link import Link


def connect(uri: str) -> Link:
    """Open the link that a URI names.

    Parameters
    ----------
    uri : str
        ``serial:///dev/ttyUSB0``: an Arduino with a radio on that port.

    Raises
    ------
    ValueError
        If no link has this scheme.
    LinkError
        If the device cannot be opened.
    """
    scheme, mark, _ = uri.partition("://")
    if mark and scheme == "serial":
        from matchset.links.arduino import ArduinoLink

        return ArduinoLink(uri)
    raise ValueError(f"a link is named like serial:///dev/ttyUSB0, got {uri!r}")
