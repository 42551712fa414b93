"""Records of an MCAP file, chunk by chunk: `read_records`; a damaged chunk is told, what follows it is read."""

from collections.abc import Iterator
from typing import IO, Any, NamedTuple

from matchset.image.files.limits import LIMITS

LARGEST_RECORD = 2**30  # format: bytes; a longer record is taken for damage


class DamagedChunk(NamedTuple):
    """A chunk whose content is not what was written.

    Attributes
    ----------
    start, end : float
        Times of its first and last message, s, as far as its head can be believed.
    reason : str
    """

    start: float
    end: float
    reason: str


def read_records(file: IO[bytes]) -> Iterator[Any]:
    """Yield the records of a file in the order in which they were written, a `DamagedChunk` in place of such a one.

    Parameters
    ----------
    file : binary file, at its beginning

    Raises
    ------
    mcap.exceptions.EndOfFile
        If the file ends in the middle.
    mcap.exceptions.InvalidMagic
        If it is no MCAP file.
    Exception
        Of any other kind, if it is damaged outside its chunks: nothing behind that can be found.
    """
    from mcap.records import Chunk
    from mcap.stream_reader import StreamReader, breakup_chunk

    for record in StreamReader(file, emit_chunks=True, record_size_limit=LARGEST_RECORD).records:
        if not isinstance(record, Chunk):
            yield record
            continue
        start, end = 1e-9 * record.message_start_time, 1e-9 * record.message_end_time
        if record.uncompressed_size > LIMITS.chunk:
            yield DamagedChunk(start, end, f"a chunk unpacks to {record.uncompressed_size} bytes")
            continue
        try:
            inside = breakup_chunk(record, validate_crc=True)
        except Exception as error:  # a damaged chunk brings out errors of every kind
            yield DamagedChunk(start, end, str(error) or type(error).__name__)
            continue
        yield from inside
