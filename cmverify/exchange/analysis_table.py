"""The tables of analyses in scene files, as the analyses' own signatures declare them.

``[modes]`` with ``count = 10`` is `solver.analyses.modes` with ``run(scene, count=10)``: names,
kinds and defaults are those of its keywords (`solver.analyses.registry`). A table that `model`
declares by hand says more about its values and is taken instead.
"""

from __future__ import annotations

import types
from collections.abc import Callable, Sequence
from functools import cache
from inspect import Parameter
from math import inf
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import Discriminator, Field, StrictBool, Tag, create_model

from cmverify.exchange.body_tables import Region
from cmverify.exchange.meanings import meanings
from cmverify.exchange.model import Fracture, SceneFile
from cmverify.exchange.table import Table
from cmverify.exchange.values import (
    Condition,
    Count,
    FileName,
    Levels,
    Number,
    Point,
    Points,
    Scalar,
    Vector,
)

#: Where something is: a condition, or shapes.
Place = Annotated[
    Annotated[Condition, Tag("condition")] | Annotated[Region, Tag("shapes")],
    Discriminator(lambda given: "shapes" if isinstance(given, list | dict) else "condition"),
]


@cache
def scene_model() -> type[SceneFile]:
    """The model of a scene file with the tables of all analyses."""
    from solver.analyses import analyses

    tables: dict[str, Any] = {
        name: (
            table_of(name, analysis.says, analysis.options, meanings(analysis.run)) | None,
            None,
        )
        for name, analysis in analyses().items()
        if name not in SceneFile.model_fields
    }
    return create_model("SceneFile", __base__=SceneFile, __doc__=SceneFile.__doc__, **tables)


def table_of(
    name: str, says: str, options: dict[str, Parameter], means: dict[str, str] | None = None
) -> type[Table]:
    """A table whose keys are some keywords, with what they mean.

    Raises
    ------
    TypeError
        If a keyword is of a kind that a file cannot say.
    """
    keys: dict[str, Any] = {}
    for key, option in options.items():
        default = ... if option.default is Parameter.empty else option.default
        said = (means or {}).get(key) or None
        if said and said.startswith("As of") and key in Fracture.model_fields:
            said = Fracture.model_fields[key].description
        if default == inf:  # which JSON does not know
            default = None
        keys[key] = (kind_of(key, option.annotation), Field(default=default, description=said))
    return create_model(f"{name.title()}Table", __base__=Table, __doc__=says, **keys)


def kind_of(key: str, annotation: Any) -> Any:
    """What a file says for a keyword of this annotation, checked.

    ``Annotated[Value, 2]`` is a value of two components.
    """
    import solver

    origin, members = get_origin(annotation), get_args(annotation)
    if origin in (Union, types.UnionType):
        several = [member for member in members if member is not types.NoneType]
        optional = len(several) < len(members)
        function = any(get_origin(member) is Callable or _callable(member) for member in several)
        if function:
            numbers = any(member in (float, int) for member in several)
            drawn = any(isinstance(m, type) and issubclass(m, solver.Region) for m in several)
            found: Any = Scalar if numbers else Place if drawn else Condition
        elif len(several) == 1:
            found = kind_of(key, several[0])
        else:
            raise TypeError(f"a scene file cannot say {key!r}: {annotation}")
        return found | None if optional else found
    if origin is Literal:
        return annotation
    if origin is Annotated and members[1] == 2:
        return Vector
    if origin is tuple and members == (float, float):
        return Point
    if isinstance(origin, type) and issubclass(origin, Sequence):
        if members[0] is float:
            return Levels
        if members[0] == tuple[float, float]:
            return Points
    simple = {bool: StrictBool, int: Count, float: Number, str: FileName}
    if annotation in simple:
        return simple[annotation]
    raise TypeError(f"a scene file cannot say {key!r}: {annotation}")


def _callable(member: Any) -> bool:
    origin = get_origin(member)
    return isinstance(origin, type) and issubclass(origin, Callable)  # type: ignore[arg-type]
