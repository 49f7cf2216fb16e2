"""A table of a scene file, as all of them are: no keys but those declared."""

from __future__ import annotations

import difflib
from collections.abc import Mapping
from typing import Any

from pydantic import BaseModel, ConfigDict, model_validator
from pydantic_core import PydanticCustomError


def wrong(key: str, message: str) -> PydanticCustomError:
    """An error of a whole table that points to one of its keys."""
    # The message is a template: what it says is not.
    return PydanticCustomError("scene", "{said}", {"said": message, "key": key})


class Table(BaseModel):
    """A table of a scene file: no keys but those declared."""

    model_config = ConfigDict(extra="forbid", frozen=True, arbitrary_types_allowed=True)

    @model_validator(mode="before")
    @classmethod
    def _known(cls, data: Any) -> Any:
        if not isinstance(data, Mapping):
            raise ValueError("must be a table of keys and values")
        for key in data:
            if key not in cls.model_fields:
                near = difflib.get_close_matches(key, cls.model_fields, n=1, cutoff=0.5)
                known = ", ".join(sorted(cls.model_fields))
                hint = f"did you mean {near[0]!r}?" if near else f"known: {known}"
                raise wrong(key, f"unknown key {key!r}; {hint}")
        return data
