"""A peer in a process of its own: `python -m benchmarks.crowds.peers.process KEY`, lines of JSON in and out.

A line in is an object of parameters, after which it begins anew and answers an empty line, or a list of detections of
a frame. The answer to those is a list: the s that it took, and the list of what was named.
"""

import json
import sys
import time

from benchmarks.crowds.peers.peer import PEERS, Step


def main(key: str) -> None:
    """Answer lines until there are no more."""
    step: Step | None = None
    for line in sys.stdin:
        given = json.loads(line)
        if isinstance(given, dict):
            step = PEERS[key].start(key, given)
            print(flush=True)
            continue
        if step is None:
            raise ValueError("detections before parameters")
        begin = time.perf_counter()
        named = step([tuple(each) for each in given])
        print(json.dumps([time.perf_counter() - begin, named]), flush=True)


if __name__ == "__main__":
    main(sys.argv[1])
