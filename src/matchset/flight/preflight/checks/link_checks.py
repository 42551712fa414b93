"""Is a link well while its motors are off: state, warnings, errors, battery? Pure checks of what it says."""

import math

import msgspec

from matchset.flight.preflight.outcome import CheckOutcome, judged, skipped
from matchset.flight.preflight.parameters import PreflightParameters
from matchset.links.crsf.crsf_link import CrsfLink
from matchset.links.link import Link, LinkStatus

ADVICE = {
    "armed": "it is armed: by another program or another transmitter? Switch the vehicle off, end the other one",
    "holding": "it is armed: by another program or another transmitter? Switch the vehicle off, end the other one",
    "binding": "wait until it has bound, a few seconds; then begin again",
    "failsafe": "it hears nothing, or was stopped: is the vehicle on and near, is the failsafe's cause gone?",
    "locked": "read its words; docs/radio.md, docs/crsf.md, docs/mavlink.md and docs/tello.md have tables of them",
}


class BatteryNews(msgspec.Struct, frozen=True):
    """What a link tells of the vehicle's battery.

    Parameters
    ----------
    charge : float or None
        What is left, 0 ... 1.
    voltage : float or None
        V, of all cells.
    """

    charge: float | None = None
    voltage: float | None = None


def battery_news(link: Link) -> BatteryNews:
    """Return what a link knows of the battery; an Arduino's toy tells nothing.

    Parameters
    ----------
    link : Link
    """
    news = getattr(link, "news", None)  # of a CrsfLink
    if news is not None and news.battery is not None:
        return BatteryNews(voltage=news.battery.voltage)  # its share left counts from a capacity that nobody set
    client = getattr(link, "client", None)
    told = getattr(client, "telemetry", None)  # of a MavlinkLink
    if told is not None:
        return BatteryNews(told.charge, told.voltage)
    state = getattr(client, "state", None)  # of a TelloLink
    return BatteryNews() if state is None else BatteryNews(charge=state.battery)


def status_checks(status: LinkStatus, sent: int, parameters: PreflightParameters) -> list[CheckOutcome]:
    """Check what a link says of itself after some zero commands.

    Parameters
    ----------
    status : LinkStatus
    sent : int
        How many commands were sent.
    parameters : PreflightParameters
    """
    share = status.errors / max(sent, 1)
    refuses = f", {status.reason}" if status.reason else ""
    return [
        judged(
            "link: state",
            "locked, and it refuses nothing",
            f"{status.state}{refuses} ({status.version})",
            status.state == "locked" and not status.reason,
            ADVICE[status.state],
        ),
        judged(
            "link: warnings",
            "none",
            "; ".join(status.warnings) or "none",
            not status.warnings,
            ADVICE["locked"],
        ),
        judged(
            "link: errors",
            f"at most {parameters.most_errors:.0%} of {sent} messages",
            f"{status.errors}",
            share <= parameters.most_errors,
            "another cable or port, antennas on, the baud rate; the vehicle nearer",
        ),
    ]


def battery_check(news: BatteryNews, parameters: PreflightParameters) -> CheckOutcome:
    """Check that the battery lasts for a first flight.

    Parameters
    ----------
    news : BatteryNews
    parameters : PreflightParameters
    """
    name, advice = "link: battery", "charge it, or plug a full one in"
    if news.charge is not None:
        wanted = f"at least {parameters.least_charge:.0%}"
        return judged(name, wanted, f"{news.charge:.0%}", news.charge >= parameters.least_charge, advice)
    wanted = f"at least {parameters.least_cell:g} V a cell"
    if not news.voltage:
        return skipped(name, wanted, "this link tells nothing of the battery: measure it, and plug a full one in")
    cells = math.ceil(news.voltage / parameters.full_cell)
    each = news.voltage / cells
    words = f"{news.voltage:.1f} V, {each:.2f} V a cell if it has {cells}"
    return judged(name, wanted, words, each >= parameters.least_cell, advice)


def vehicle_check(link: Link) -> CheckOutcome:
    """Check what a flight controller behind a transmitter module says of itself.

    Parameters
    ----------
    link : Link
        After some zero commands.
    """
    name, wanted = "link: vehicle", "it answers, is disarmed, and sticks are angles"
    if not isinstance(link, CrsfLink):
        return skipped(name, wanted, "this link speaks for its vehicle: see the state")
    news, longest = link.news, link.parameters.vehicle_timeout
    if not news.age <= longest:
        advice = "switch it on, bind it, telemetry on ('Telem Ratio'); docs/crsf.md"
        words = "nothing heard" if math.isinf(news.age) else f"nothing heard for {news.age:.1f} s"
        return judged(name, wanted, words, math.isinf(longest), advice)
    mode = news.mode
    if mode is None:
        return skipped(name, wanted, "it does not tell its mode: 'feature TELEMETRY' of Betaflight")
    if mode.failsafe or not mode.disarmed:
        advice = "another transmitter has armed it, another arm channel (?arm_channel=6), or it hears nothing"
        return judged(name, wanted, f"mode {mode.text!r}", False, advice)
    advice = "set the angle mode: docs/betaflight.txt"
    return judged(name, wanted, f"mode {mode.text!r}", not mode.commands_rates, advice)
