"""What a check of `matchset preflight` has found: `CheckOutcome`, made by `judged`, `failed` and `skipped`."""

from typing import Literal

import msgspec

from matchset.app.exit_codes import BAD_INPUT, DEVICE, NOT_FOUND
from matchset.image.errors import LinkError

Verdict = Literal["pass", "fail", "skipped"]


class CheckOutcome(msgspec.Struct, frozen=True):
    """One check, and what it found.

    Parameters
    ----------
    name : str
        What is checked: "camera: rate".
    wanted : str
        What it must show, in words, with the limit.
    measured : str
        What it showed.
    verdict : str
        "pass", "fail" or "skipped".
    advice : str
        What to do where it failed, or why it was skipped; empty where it passed.
    code : int
        Exit code where it failed: 1, 2 for a file or an option, 3 for a device.
    """

    name: str
    wanted: str
    measured: str
    verdict: Verdict
    advice: str = ""
    code: int = NOT_FOUND

    @property
    def is_failed(self) -> bool:
        """Whether nothing must go on after it."""
        return self.verdict == "fail"


def judged(name: str, wanted: str, measured: str, good: bool, advice: str) -> CheckOutcome:
    """Return a check that passes or fails.

    Parameters
    ----------
    name, wanted, measured : str
        See `CheckOutcome`.
    good : bool
        Whether it passes.
    advice : str
        What to do if it does not.
    """
    return CheckOutcome(name, wanted, measured, "pass" if good else "fail", "" if good else advice)


def failed(name: str, wanted: str, why: Exception | str, advice: str = "") -> CheckOutcome:
    """Return a check that could not even be made: a file or a device is to blame.

    Parameters
    ----------
    name, wanted : str
        See `CheckOutcome`.
    why : Exception or str
        What was measured: an error, of a file or an option unless it is a `LinkError`, or the fault of a device.
    advice : str
        What to do.
    """
    code = BAD_INPUT if isinstance(why, Exception) and not isinstance(why, LinkError) else DEVICE
    return CheckOutcome(name, wanted, " ".join(str(why).split()), "fail", advice, code)


def skipped(name: str, wanted: str, why: str) -> CheckOutcome:
    """Return a check that was not made.

    Parameters
    ----------
    name, wanted : str
        See `CheckOutcome`.
    why : str
        Why not, in words.
    """
    return CheckOutcome(name, wanted, "-", "skipped", why)
