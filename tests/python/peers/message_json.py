"""Messages of any of the Python libraries, as plain JSON values."""

import dataclasses
import math
from collections.abc import Mapping, Sequence


def as_json(value: object) -> object:
    """Plain dictionaries, lists, numbers and strings. Numbers that are not finite become strings."""
    if isinstance(value, bool | str | int) or value is None:
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else str(value)
    if isinstance(value, bytes | bytearray):
        return list(value)
    if hasattr(value, "tolist"):
        return as_json(value.tolist())
    if hasattr(value, "get_fields_and_field_types"):
        return {name: as_json(getattr(value, name)) for name in value.get_fields_and_field_types()}
    if dataclasses.is_dataclass(value):
        return {
            field.name: as_json(getattr(value, field.name))
            for field in dataclasses.fields(value)
            if not field.name.startswith("__")
        }
    if isinstance(value, Mapping):
        return {str(key): as_json(entry) for key, entry in value.items()}
    if isinstance(value, Sequence):
        return [as_json(entry) for entry in value]
    slots = getattr(value, "__slots__", None)
    names = slots if slots is not None else vars(value)
    return {name: as_json(getattr(value, name)) for name in names if not name.startswith("_")}
