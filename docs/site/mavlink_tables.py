"""The table of messages in docs/mavlink.md, from the table from which they are packed.

`python docs/site/mavlink_tables.py` writes it into the page.
`tests/links/mavlink/test_mavlink_docs.py` compares.
"""

from pathlib import Path

from matchset.links.mavlink.message import MessageField
from matchset.links.mavlink.messages import MESSAGES

PAGE = Path(__file__).resolve().parents[1] / "mavlink.md"
BEGIN, END = "<!-- messages -->\n", "<!-- end -->"


def filled(page: str) -> str:
    """Return the page with its table written anew."""
    head, _, rest = page.partition(BEGIN)
    lines = ["| id | message | CRC extra | bytes | what for |", "| ---: | --- | ---: | ---: | --- |"]
    lines += [f"| {m.id} | {m.name} | {m.crc_extra} | {m.layout.size} | {m.what} |" for m in MESSAGES]
    for message in MESSAGES:
        lines += ["", f"**{message.name}**: " + "; ".join(map(_field, message.fields)) + "."]
    return head + BEGIN + "\n" + "\n".join(lines) + "\n\n" + rest[rest.index(END) :]


def _field(field: MessageField) -> str:
    said = ", ".join(word for word in (field.unit, field.what) if word)
    return f"`{field.name}` {field.kind}" + (f" ({said})" if said else "")


if __name__ == "__main__":
    PAGE.write_text(filled(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
