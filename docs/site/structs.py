"""Tell griffe, which reads the sources, what msgspec makes of a struct: a constructor with the fields as parameters."""

from collections.abc import Iterator
from typing import Any

import griffe


class StructSignatures(griffe.Extension):
    """Give each `msgspec.Struct` the `__init__` that its fields, and those of its bases, imply."""

    def on_package(self, *, pkg: griffe.Module, **_: Any) -> None:
        """Add the constructor to all structs of a package."""
        for cls in _classes(pkg):
            if "__init__" not in cls.members and _is_struct(cls):
                cls.set_member("__init__", _constructor(cls))


def _classes(module: griffe.Module) -> Iterator[griffe.Class]:
    for member in module.members.values():
        if isinstance(member, griffe.Class):
            yield member
        elif isinstance(member, griffe.Module):
            yield from _classes(member)


def _family(cls: griffe.Class) -> list[griffe.Class]:
    """Return the class's bases within the package, the remotest first, and the class."""
    bases = [base for base in reversed(cls.mro()) if not base.is_alias]
    return [*bases, cls]


def _is_struct(cls: griffe.Class) -> bool:
    return any("Struct" in str(base) for each in _family(cls) for base in each.bases)


def _constructor(cls: griffe.Class) -> griffe.Function:
    any_way, by_name = griffe.ParameterKind.positional_or_keyword, griffe.ParameterKind.keyword_only
    parameters = {"self": griffe.Parameter("self", kind=any_way)}
    for each in _family(cls):
        kind = by_name if str(each.keywords.get("kw_only")) == "True" else any_way
        for field in each.members.values():
            if isinstance(field, griffe.Attribute) and "instance-attribute" in field.labels:
                default = None if field.value is None else str(field.value)
                parameters[field.name] = griffe.Parameter(
                    field.name, annotation=field.annotation, kind=kind, default=default
                )
    return griffe.Function("__init__", parameters=griffe.Parameters(*parameters.values()))
