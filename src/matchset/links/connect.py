"""Open the link that a URI names: `connect`."""

from matchset.links.link import Link


def connect(uri: str) -> Link:
    """Open the link that a URI names.

    Parameters
    ----------
    uri : str
        ``serial:///dev/ttyUSB0``: an Arduino with a radio on that port. ``crsf:///dev/ttyUSB0``: an ExpressLRS or
        Crossfire module. ``mavlink:udpin:0.0.0.0:14550``: an autopilot. ``tello:``: a Tello in its own
        Wi-Fi. ``sim://chain``: the first vehicle of a simulated chain; its camera is ``link.chain.cameras[0]``.

    Raises
    ------
    ValueError
        If no link has this scheme.
    LinkError
        If the device cannot be opened.
    """
    if uri.startswith("mavlink:"):
        from matchset.links.mavlink.mavlink_link import MavlinkLink

        return MavlinkLink(uri)
    if uri.startswith("tello:"):
        from matchset.links.tello.tello_link import TelloLink

        return TelloLink(uri)
    scheme, mark, _ = uri.partition("://")
    if mark and scheme == "serial":
        from matchset.links.arduino.arduino_link import ArduinoLink

        return ArduinoLink(uri)
    if mark and scheme == "crsf":
        from matchset.links.crsf.crsf_link import CrsfLink

        return CrsfLink(uri)
    if mark and scheme == "sim":
        from matchset.links.simulated import SimulatedChain
        from matchset.links.simulation_parameters import parse_uri

        return SimulatedChain(parse_uri(uri)).links[0]
    forms = "serial:///dev/ttyUSB0, crsf:///dev/ttyUSB0, mavlink:udpin:0.0.0.0:14550, tello: or sim://chain"
    raise ValueError(f"a link is named like {forms}, got {uri!r}")
