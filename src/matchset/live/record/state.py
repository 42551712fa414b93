"""What the page shows of recordings: `RecordState`."""

import msgspec


class RecordedFile(msgspec.Struct, frozen=True):
    """A file of a recording.

    Parameters
    ----------
    name : str
        In its folder.
    size : int
        Bytes.
    """

    name: str
    size: int


class FinishedRecording(msgspec.Struct, frozen=True, omit_defaults=True):
    """A recording that has ended.

    Parameters
    ----------
    folder : str
        Name of the folder; a file's address is ``download/FOLDER/NAME``.
    files : list of RecordedFile
    frames : int
        Pictures in it.
    dropped : int
        Pictures that are not.
    ended : str
        What went wrong, in words; empty if nothing.
    """

    folder: str
    files: list[RecordedFile]
    frames: int
    dropped: int = 0
    ended: str = ""


class RecordState(msgspec.Struct, frozen=True, omit_defaults=True):
    """How recording goes.

    Parameters
    ----------
    on : bool
        Whether it runs.
    finishing : bool
        Whether one that was ended is still being written.
    folder : str
        Where.
    seconds : int
        How long it has been running, s.
    size : int
        Bytes so far, to 0.1 MB.
    frames, dropped : int
        Pictures that were written, and that were not: the disk or the processor was too slow.
    minutes : int or None
        For how long there is room on the disk at this rate.
    finished : list of FinishedRecording
        The last ones, newest first.
    """

    on: bool = False
    finishing: bool = False
    folder: str = ""
    seconds: int = 0
    size: int = 0
    frames: int = 0
    dropped: int = 0
    minutes: int | None = None
    finished: list[FinishedRecording] = []
