"""Keys that files had before are known in one table, which names parameters that exist, and say nothing twice."""

from typing import get_args

import msgspec
import pytest

from matchset.control.files.older_keys import OLDER_KEYS, kind_of, newer_key, with_newer_keys
from matchset.control.pid import PidParameters
from matchset.flight.chain.config import ConfigFile


def structs(kind: type[msgspec.Struct]) -> dict[str, type[msgspec.Struct]]:
    """Find every struct within a struct, by name."""
    found = {kind.__name__: kind}
    for field in msgspec.structs.fields(kind):
        for each in (field.type, *get_args(field.type)):
            if isinstance(each, type) and issubclass(each, msgspec.Struct):
                found |= structs(each)
    return found


KINDS = structs(ConfigFile)


@pytest.mark.parametrize("name", OLDER_KEYS)
def test_each_older_key_is_of_one_parameter_that_exists(name: str) -> None:
    older, fields = OLDER_KEYS[name], set(KINDS[name].__struct_fields__)
    assert set(older.values()) <= fields
    assert len(set(older.values())) == len(older)
    assert not set(older) & fields  # so a key says by itself of which time it is


def test_the_key_of_every_parameter_is_its_name() -> None:
    for kind in KINDS.values():
        assert kind.__struct_encode_fields__ == kind.__struct_fields__


def test_tables_arrays_and_unknown_keys_are_kept() -> None:
    table = {
        "flight": {"pilot": {"follower": {"level": {"most": 3.0, "unknown": 1}, "own": {"heft": 1.1}}}},
        "follower": [{"camera": 0}],
        "nobody": {"most": 1},
    }
    newer, older = with_newer_keys(table, ConfigFile)
    assert newer == {
        "flight": {
            "pilot": {
                "follower": {
                    "horizontal": {"output_limit": 3.0, "unknown": 1},
                    "ego_motion": {"effective_mass_ratio": 1.1},
                }
            }
        },
        "follower": [{"camera": 0}],
        "nobody": {"most": 1},
    }
    assert ("flight.pilot.follower.level.most", "flight.pilot.follower.horizontal.output_limit") in older
    assert len(older) == 4
    assert with_newer_keys(newer, ConfigFile) == (newer, [])


def test_a_parameter_under_both_of_its_keys_is_refused() -> None:
    for table in ({"most": 1.0, "output_limit": 2.0}, {"output_limit": 2.0, "most": 1.0}):
        with pytest.raises(ValueError, match="output_limit is there twice: most is its older name"):
            with_newer_keys(table, PidParameters)


def test_where_there_is_no_table_no_key_is_an_older_one() -> None:
    assert (newer_key("most", None), newer_key("most", ConfigFile), kind_of("flight", None)) == ("most", "most", None)
    assert kind_of("camera", ConfigFile) is None
