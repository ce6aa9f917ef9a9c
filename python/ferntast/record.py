"""Fields by name, as results have them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any


class Record:
    """Fields by name, as attributes or by `record["name"]`; `to_dict()` has them all."""

    def __init__(self, fields: dict[str, Any]) -> None:
        self._fields = fields

    def __getattr__(self, name: str) -> Any:
        fields = self.__dict__.get("_fields", {})
        if name not in fields:
            raise AttributeError(f"{type(self).__name__} has no {name!r}: {', '.join(fields)}")
        return wrapped(fields[name])

    def __getitem__(self, name: str) -> Any:
        return wrapped(self._fields[name])

    def __iter__(self) -> Iterator[str]:
        return iter(self._fields)

    def __len__(self) -> int:
        return len(self._fields)

    def __contains__(self, name: object) -> bool:
        return name in self._fields

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._fields]

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Record) and self._fields == other._fields

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        fields = ", ".join(f"{name}={_short(value)}" for name, value in self._fields.items())
        return f"{type(self).__name__}({fields})"

    def keys(self) -> list[str]:
        """Names of the fields."""
        return list(self._fields)

    def to_dict(self) -> dict[str, Any]:
        """Plain dictionaries and lists, as in JSON."""
        return self._fields


def wrapped(value: Any) -> Any:
    """Dictionaries as records, also those in lists."""
    if isinstance(value, dict):
        return Record(value)
    if isinstance(value, list) and value and isinstance(value[0], (dict, list)):
        return [wrapped(own) for own in value]
    return value


def _short(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}…"
