"""The tables of docs/live.md that follow from the code: messages and states.

`python docs/site/live_tables.py` writes them into the page.
`tests/live/test_live_docs.py` compares.
"""

import re
from pathlib import Path
from typing import Any

import msgspec
from msgspec import inspect as kinds

from matchset.live.known_messages import READER
from matchset.live.wire.messages import Ack, PageMessage
from matchset.live.wire.state import CrowdState, SessionState, State, TargetState

PAGE = Path(__file__).resolve().parents[1] / "live.md"
STATES: tuple[type[msgspec.Struct], ...] = (State, CrowdState, TargetState, SessionState)
JSON_NAMES = {"int": "integer", "float": "number", "str": "text", "bool": "true or false"}
JSON_NAMES |= {"None": "null", "dict": "object"}
ENTRY = re.compile(r"^(\w[\w, ]*) : ([^\n]*)((?:\n    +[^\n]*)*)", re.MULTILINE)


def tables() -> dict[str, str]:
    """Return all tables by the name of their place in the page."""
    return {"messages": _messages(), **{state.__name__: _state(state) for state in STATES}}


def filled(page: str) -> str:
    """Return the page with its tables written anew."""
    for name, table in tables().items():
        begin, end = f"<!-- {name} -->\n", "<!-- end -->"
        head, found, rest = page.partition(begin)
        if not found:
            raise ValueError(f"docs/live.md has no place for the table {name}")
        page = head + begin + "\n" + table + "\n" + rest[rest.index(end) :]
    return page


def _messages() -> str:
    lines = ["| message | fields | what it does |", "| --- | --- | --- |"]
    messages = [message for message in READER.types if message is not Ack]
    lines += [f"| `{each.__struct_config__.tag}` | {_fields(each)} | {_words(each)} |" for each in messages]
    return "\n".join(lines) + "\n"


def _fields(message: type[PageMessage]) -> str:
    said = []
    for field in msgspec.structs.fields(message):
        default = "" if field.required else f" = {msgspec.json.encode(field.default).decode()}"
        said.append(f"`{field.name}`: {_kind(kinds.type_info(field.type))}{default}")
    return "; ".join(said)


def _kind(kind: Any) -> str:
    """Return a type in words."""
    match kind:
        case kinds.Metadata():
            return _kind(kind.type)
        case kinds.UnionType():
            return " or ".join(map(_kind, kind.types))
        case kinds.LiteralType():
            return " or ".join(f'"{value}"' for value in kind.values)
        case kinds.ListType():
            return "list of " + _kind(kind.item_type)
    words = {"FloatType": "number", "IntType": "integer", "BoolType": "true or false", "StrType": "text"}
    return words.get(type(kind).__name__, "null")


def _words(message: type[PageMessage]) -> str:
    return " ".join((message.__doc__ or "").partition("\n\n")[0].split()).replace("None", "null")


def _state(state: type[msgspec.Struct]) -> str:
    """Fields of a state, from its docstring."""
    described = (state.__doc__ or "").partition("----------\n")[2]
    lines = ["| field | type | what it is |", "| --- | --- | --- |"]
    for names, kind, words in ENTRY.findall(re.sub(r"^ {4}", "", described, flags=re.MULTILINE)):
        fields = ", ".join(f"`{name}`" for name in names.split(", "))
        kind = re.sub(r"\w+", lambda word: JSON_NAMES.get(word[0], word[0]), kind)
        lines.append(f"| {fields} | {kind} | {' '.join(words.split())} |")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    PAGE.write_text(filled(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
