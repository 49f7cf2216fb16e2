"""Kinds of values in scene files: numbers, vectors, formulas and conditions, each checked."""

from __future__ import annotations

import math
from typing import Annotated, Any

import numpy as np
from pydantic import BeforeValidator, Field, PlainValidator, WithJsonSchema

from cmverify.exchange.expressions import Formula

#: Largest magnitude of a number, and the smallest of a length, in SI units. Powers up to the
#: eighth of what lies beyond leave the range of floating-point numbers.
LARGEST, SMALLEST = 1e30, 1e-30


def number(value: Any) -> float:
    """A finite number of a magnitude that can be calculated with."""
    if isinstance(value, str):
        raise ValueError(f"must be a number, not the text {_short(value)}")
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError(f"must be a number, not {_short(value)}")
    if not (math.isfinite(value) if isinstance(value, float) else True):
        raise ValueError(f"must be a finite number, not {value}")
    if abs(value) > LARGEST:
        raise ValueError(f"must not exceed {LARGEST:g} in magnitude, and is {_short(value)}")
    return float(value)


def positive(value: Any) -> float:
    """A number above zero."""
    found = number(value)
    if not found > 0:
        raise ValueError(f"must be positive, not {found:g}")
    if found < SMALLEST:
        raise ValueError(f"must be at least {SMALLEST:g}, not {found:g}")
    return found


def not_negative(value: Any) -> float:
    """A number of at least zero."""
    found = number(value)
    if found < 0:
        raise ValueError(f"must be at least 0, not {found:g}")
    return found


def count(value: Any) -> int:
    """A whole number of at least one."""
    if isinstance(value, bool) or not isinstance(value, int):
        raise ValueError(f"must be a whole number, not {_short(value)}")
    if not 1 <= value <= 10**12:
        raise ValueError(f"must be from 1 to 10¹², not {_short(value)}")
    return value


def scalar(value: Any, time: bool = False) -> float | Formula:
    """A number, or a formula of x and y (and of t, if it may depend on `time`)."""
    if not isinstance(value, str):
        if isinstance(value, list | dict):
            raise ValueError(f"must be a number or a formula, not {_short(value)}")
        return number(value)
    formula = Formula(value, time)
    if formula.condition:
        raise ValueError(f"needs a value, and {value!r} is a condition")
    return formula


def scalar_in_time(value: Any) -> float | Formula | InTime:
    """A number, or a formula of x, y and t."""
    found = scalar(value, time=True)
    return InTime(found) if isinstance(found, Formula) and found.timed else found


class InTime:
    """A formula that depends on time, or a vector of such, as a function of x, y and t."""

    def __init__(self, of: Formula | Components) -> None:
        self.of = of

    def __call__(self, x: np.ndarray, y: np.ndarray, t: float) -> np.ndarray:
        """Values at one time."""
        return self.of(x, y, t)

    @property
    def texts(self) -> list[str]:
        """The formulas that depend on time."""
        parts = self.of.parts if isinstance(self.of, Components) else [self.of]
        return [part.text for part in parts if isinstance(part, Formula) and part.timed]


def condition(value: Any) -> Formula:
    """A condition on x and y."""
    if not isinstance(value, str):
        raise ValueError(f'must be a condition such as "x < 1", not {_short(value)}')
    formula = Formula(value)
    if not formula.condition:
        raise ValueError(f'must be a condition such as "x < 1", and {value!r} is a value')
    return formula


class Components:
    """Components of a vector, each a number or a formula, as a function of x and y (and t)."""

    def __init__(self, parts: list[float | Formula]) -> None:
        self.parts = parts

    def __call__(self, x: np.ndarray, y: np.ndarray, t: float = 0.0) -> np.ndarray:
        """Values, shape (*x.shape, components)."""
        values = [
            p(x, y, t) if isinstance(p, Formula) else np.full(np.shape(x), p) for p in self.parts
        ]
        return np.stack(values, axis=-1)

    @property
    def timed(self) -> bool:
        """Whether a component depends on t."""
        return any(isinstance(part, Formula) and part.timed for part in self.parts)


def components(size: int, time: bool = False) -> Any:
    """Validator of a list of `size` numbers or formulas, which may depend on `time`."""

    def check(value: Any) -> Components | InTime:
        if not isinstance(value, list):
            raise ValueError(f"must be a list of {size} numbers or formulas, not {_short(value)}")
        if len(value) != size:
            raise ValueError(f"must have {size} components, not {len(value)}")
        found = Components([scalar(part, time) for part in value])
        return InTime(found) if found.timed else found

    return check


def force_or_source(value: Any) -> Any:
    """Two numbers or formulas (a force), or one (a source); they may depend on time."""
    return components(2, time=True)(value) if isinstance(value, list) else scalar_in_time(value)


def steady_force_or_source(value: Any) -> list[float] | float:
    """Two numbers (a force), or one (a source)."""
    return (
        [float(part) for part in _nested(value, (2,))] if isinstance(value, list) else number(value)
    )


def numbers(*shape: int) -> Any:
    """Validator of a list of numbers of this length, or of lists; 0 is any length."""

    def check(value: Any) -> Any:
        return _nested(value, shape)

    return check


def file_name(value: Any) -> str:
    """A name that a file can have."""
    if not isinstance(value, str) or not value.strip():
        raise ValueError(f"must be the name of a file, not {_short(value)}")
    if not value.isprintable():
        raise ValueError(f"the name of a file holds no control characters: {_short(value)}")
    return value


def _nested(value: Any, shape: tuple[int, ...]) -> Any:
    if not shape:
        return number(value)
    what = "numbers" if len(shape) == 1 else f"lists of {shape[1]} numbers"
    if not isinstance(value, list):
        raise ValueError(f"must be a list of {what}, not {_short(value)}")
    if shape[0] and len(value) != shape[0]:
        raise ValueError(f"must be a list of {shape[0]} {what}, not of {len(value)}")
    try:
        return [_nested(part, shape[1:]) for part in value]
    except ValueError as error:
        said = str(error)
        raise ValueError(said if said.startswith("each") else f"each entry {said}") from None


def _short(value: Any) -> str:
    if isinstance(value, dict):
        return "a table"
    if isinstance(value, int) and abs(value) >= 10**15:
        # Turning a long integer into decimal digits is refused by Python.
        return f"about 10^{int(value.bit_length() * math.log10(2))}"
    text = str(value).lower() if isinstance(value, bool) else repr(value)
    return text if len(text) <= 60 else f"{text[:60]}…"


def _schema(**schema: Any) -> WithJsonSchema:
    return WithJsonSchema(schema)


def _formula(of: str) -> dict[str, Any]:
    return {"anyOf": [{"type": "number"}, {"type": "string", "description": f"formula of {of}"}]}


_VALUE, _VALUE_IN_TIME = _formula("x and y"), _formula("x, y and t")


def _list(item: dict[str, Any], size: int) -> dict[str, Any]:
    limits = {"minItems": size, "maxItems": size} if size else {}
    return {"type": "array", "items": item, **limits}


Number = Annotated[float, BeforeValidator(number)]
Positive = Annotated[
    float, BeforeValidator(positive), Field(json_schema_extra={"exclusiveMinimum": 0})
]
NotNegative = Annotated[
    float, BeforeValidator(not_negative), Field(json_schema_extra={"minimum": 0})
]
Count = Annotated[int, BeforeValidator(count), Field(json_schema_extra={"minimum": 1})]
FileName = Annotated[str, BeforeValidator(file_name)]
Scalar = Annotated[Any, PlainValidator(scalar), _schema(**_VALUE)]
Condition = Annotated[Any, PlainValidator(condition), _schema(type="string", format="condition")]
Vector = Annotated[Any, PlainValidator(components(2)), _schema(**_list(_VALUE, 2))]
ScalarInTime = Annotated[Any, PlainValidator(scalar_in_time), _schema(**_VALUE_IN_TIME)]
VectorInTime = Annotated[
    Any, PlainValidator(components(2, time=True)), _schema(**_list(_VALUE_IN_TIME, 2))
]
TripleInTime = Annotated[
    Any, PlainValidator(components(3, time=True)), _schema(**_list(_VALUE_IN_TIME, 3))
]
_NUMBER = {"type": "number"}
ForceOrSource = Annotated[
    Any,
    PlainValidator(force_or_source),
    _schema(anyOf=[_list(_VALUE_IN_TIME, 2), *_VALUE_IN_TIME["anyOf"]]),
]
SteadyForceOrSource = Annotated[
    Any,
    PlainValidator(steady_force_or_source),
    _schema(anyOf=[_list(_NUMBER, 2), _NUMBER]),
]
Point = Annotated[list[float], BeforeValidator(numbers(2)), _schema(**_list(_NUMBER, 2))]
Triple = Annotated[list[float], BeforeValidator(numbers(3)), _schema(**_list(_NUMBER, 3))]
Points = Annotated[
    list[list[float]], BeforeValidator(numbers(0, 2)), _schema(**_list(_list(_NUMBER, 2), 0))
]
Levels = Annotated[list[float], BeforeValidator(numbers(0)), _schema(**_list(_NUMBER, 0))]
Matrix2 = Annotated[
    list[list[float]], BeforeValidator(numbers(2, 2)), _schema(**_list(_list(_NUMBER, 2), 2))
]
Matrix3 = Annotated[
    list[list[float]], BeforeValidator(numbers(3, 3)), _schema(**_list(_list(_NUMBER, 3), 3))
]
