"""What the page shows of other computers: `SharingState`."""

import msgspec


class SharedTargetState(msgspec.Struct, frozen=True, omit_defaults=True):
    """A target of a partner.

    Parameters
    ----------
    name : str
    position : list of float
        x, y and z in the frame of the partner's camera, m; empty where it has none or must not be used.
    sigma : float
        Largest standard deviation of these, m.
    reason : str
        Why it must not be used; empty if it may.
    """

    name: str
    position: list[float] = []
    sigma: float = 0.0
    reason: str = ""


class SharingPartnerState(msgspec.Struct, frozen=True, omit_defaults=True):
    """A partner.

    Parameters
    ----------
    name : str
    here, silent : bool
    age_ms : int or None
        Of its newest picture, in steps of 10; None if that is not known.
    offset : float or None
        This computer's clock minus its clock, s; None if that is not known.
    offset_uncertainty_ms : float
        It is off by no more.
    received, missed : int
        Messages.
    targets : list of SharedTargetState
    """

    name: str
    here: bool
    silent: bool = False
    age_ms: int | None = None
    offset: float | None = None
    offset_uncertainty_ms: float = 0.0
    received: int = 0
    missed: int = 0
    targets: list[SharedTargetState] = []


class SharingState(msgspec.Struct, frozen=True, omit_defaults=True):
    """What is shared.

    Parameters
    ----------
    name : str
        Under which name.
    key : str
    partners : list of SharingPartnerState
    """

    name: str
    key: str
    partners: list[SharingPartnerState] = []
