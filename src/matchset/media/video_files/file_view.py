"""How the pictures of a file are to be looked at, by what its header says: `file_view`."""

from collections.abc import Sequence

from matchset.media.capture import Capture
from matchset.media.upright.header_view import pixel_ratio, stated_orientation, stored_size, take_as_stored
from matchset.media.upright.orientation import AS_STORED, Orientation
from matchset.media.upright.view import View, Wish, view_of
from matchset.media.video_files.mp4_tracks import VideoTrack


def file_view(capture: Capture, tracks: Sequence[VideoTrack], number: int, wish: Wish) -> View:
    """Say what is done to every picture of a file.

    Parameters
    ----------
    capture : Capture
        The file, open; from here on it hands out pictures as they are stored.
    tracks : sequence of VideoTrack
        Of an MP4, MOV or Matroska; empty for other files, of which OpenCV knows the angle.
    number : int
        Which of them is read.
    wish : Wish

    Returns
    -------
    View
    """
    take_as_stored(capture)
    track = tracks[number] if number < len(tracks) else None
    stored, notes = (AS_STORED, []) if track is None else _by_matrix(track)
    if stored == AS_STORED and not notes:
        stored = stated_orientation(capture)
    view = view_of(pixel_ratio(capture), stored, stored_size(capture), wish)
    return view._replace(notes=(*notes, *view.notes))


def _by_matrix(track: VideoTrack) -> tuple[Orientation, list[str]]:
    """Return the orientation of a track, and what is to be said of its header."""
    notes, orientation = [], Orientation.of_matrix(track.matrix)
    if orientation is None:
        kind = "has" if any(track.matrix) else "is zero, or has"
        notes.append(f"the file's display matrix {kind} no turn by quarters: pictures are shown as they are stored")
    if track.ratio is not None and 0 in track.ratio:
        notes.append(f"the header's pixels of {track.ratio[0]}:{track.ratio[1]} are not credible: ignored")
    return orientation or AS_STORED, notes
