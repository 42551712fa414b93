"""Tell griffe, which reads the sources, what msgspec makes of a struct: a constructor with the fields as parameters."""

from typing import Any

import griffe


class StructSignatures(griffe.Extension):
    """Give each `msgspec.Struct` the `__init__` that its fields imply."""

    def on_class_members(self, *, cls: griffe.Class, **_: Any) -> None:
        """Add the constructor to a struct that has none."""
        if "__init__" in cls.members or not any("Struct" in str(base) for base in cls.bases):
            return
        any_way, by_name = griffe.ParameterKind.positional_or_keyword, griffe.ParameterKind.keyword_only
        kind = by_name if str(cls.keywords.get("kw_only")) == "True" else any_way
        parameters = [griffe.Parameter("self", kind=any_way)]
        for field in cls.members.values():
            if isinstance(field, griffe.Attribute) and "instance-attribute" in field.labels:
                default = None if field.value is None else str(field.value)
                parameters.append(griffe.Parameter(field.name, annotation=field.annotation, kind=kind, default=default))
        cls.set_member("__init__", griffe.Function("__init__", parameters=griffe.Parameters(*parameters)))
