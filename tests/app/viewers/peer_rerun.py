"""Reads a file of `--rerun` with Rerun's own package; prints what it found as JSON. Run by the Python of .viewers."""

import json
import sys
from typing import Any

import pyarrow
import rerun.chunk


def looked_at(path: str) -> dict[str, Any]:
    """Components and timelines of each entity, and the numbers that are compared."""
    reader = rerun.chunk.RrdReader(path)
    found: dict[str, Any] = {}
    for chunk in reader.stream().collect().stream():
        if chunk.entity_path == "/__properties":
            continue
        batch = chunk.to_record_batch()
        entity = found.setdefault(
            chunk.entity_path, {"timelines": [], "rows": 0, "columns": {}, "kinds": {}, "cleared": []}
        )
        entity["rows"] += batch.num_rows
        entity["static"] = chunk.is_static
        entity["timelines"] = sorted({*entity["timelines"], *chunk.timeline_names})
        if "Clear:is_recursive" in batch.schema.names:
            entity["cleared"] += batch.column("frame").to_pylist()
            continue
        for name in batch.schema.names:
            if name.startswith("rerun.controls"):
                continue
            column = batch.column(name)
            entity["kinds"][name] = str(column.type)
            if pyarrow.types.is_temporal(column.type):
                column = column.cast(pyarrow.int64())
            values = column.to_pylist()
            if name == "EncodedImage:blob":
                values = [bytes(each[0][:2]).hex() for each in values]
            entity["columns"].setdefault(name, []).extend(values)
    return {"entities": found, "recordings": len(reader.recordings()), "blueprints": len(reader.blueprints())}


if __name__ == "__main__":
    print(json.dumps(looked_at(sys.argv[1]), default=repr))
