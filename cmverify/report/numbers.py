"""The format of results.json: what each entry is, as models that read it and as a JSON schema.

The schema is what `cmverify report --schema` prints. `FORMAT` grows by one when an entry goes or
changes its meaning; a new entry does not change it, and readers should pass over what they do not
know, as these models do.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, Field, ValidationError

FORMAT = 1
#: A figure; null where it is not a number.
Figure = float | None


class Counts(BaseModel):
    """How many there are of what."""

    cases: int
    good_cases: int = Field(description="cases of which every check holds")
    checks: int = Field(description="depends on what was asked for, not on what came of it")
    good_checks: int
    measurements: int
    crashed: int = Field(description="measurements that raised, or whose process died")
    missing: int = Field(description="measurements without a usable record")
    passed: bool


class Run(BaseModel):
    """How a run was made."""

    level: Literal["quick", "standard", "paper"]
    jobs: int = Field(description="worker processes")
    threads: int = Field(description="threads of each")
    command: str
    started: str = Field(description="date and time, ISO 8601")
    wall_seconds: float = Field(description="s, the whole run")
    environment: dict[str, Any] = Field(description="versions, machine, commit")
    measured: list[tuple[str, str, int]] = Field(description="case, method, resolution")
    finished: bool
    kept: list[dict[str, Any]] = Field(description="earlier runs whose cases are kept")


class CaseRun(BaseModel):
    """The run that measured a case."""

    level: Literal["quick", "standard", "paper"]
    started: str
    command: str


class Verdict(BaseModel):
    """What one check says; "ran" and "silent" are no checks and only ever fail."""

    case: str
    method: str
    quantity: str
    kind: Literal["ran", "silent", "bound", "equal", "order"]
    where: str = Field(description="spacings, as fractions of the case's length")
    value: Figure
    asked: str = Field(description="what must hold, in words")
    passed: bool
    message: str
    margin: Figure = Field(description="share of the bound that is used up")


class Failure(BaseModel):
    """A method that raised."""

    error: str
    message: str
    traceback: str


class Measurement(BaseModel):
    """One method at one resolution."""

    method: str
    kind: Literal["bond", "fem", "exact", "other"]
    resolution: int = Field(description="spacing or element size is the case's length over it")
    unknowns: int | None
    quantities: dict[str, Figure] = Field(description="figures by the names in the case")
    orders: dict[str, Figure] = Field(description="observed orders from the next coarser one")
    seconds: dict[str, Figure] = Field(description="wall s by stage, compilation excluded")
    total: Figure = Field(description="s of set-up and solve together")
    statistics: dict[str, Any]
    failure: Failure | None
    warnings: list[str]


class Point(BaseModel):
    """One measurement in the work-precision diagram."""

    method: str
    kind: Literal["bond", "fem", "exact", "other"]
    resolution: int
    unknowns: int
    seconds: Figure
    error: Figure


class Case(BaseModel):
    """A problem with its measurements and verdicts."""

    title: str
    section: str = Field(description="of the paper")
    shows: str
    length: str
    primary: str = Field(description="the quantity of the work-precision diagram")
    passed: bool
    run: CaseRun
    quantities: dict[str, str] = Field(description="what each figure is")
    verdicts: list[Verdict]
    not_judged_at_this_level: list[tuple[str, str]]
    measurements: list[Measurement]
    work_precision: list[Point]


class Results(BaseModel):
    """All numbers of a run: results.json."""

    format: Literal[1] = Field(description="of this file; see the module's docstring")
    passed: bool
    counts: Counts
    run: Run
    cases: dict[str, Case]


def schema() -> dict[str, Any]:
    """The JSON schema (2020-12) of results.json."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **Results.model_json_schema(),
    }


def read(path: Path) -> Results:
    """Read results.json.

    Raises
    ------
    ValueError
        If it cannot be read, is of another format or lacks something, in one line.
    """
    try:
        text = path.read_text(encoding="utf-8")
        return Results.model_validate_json(text)
    except OSError as error:
        raise ValueError(f"{path} cannot be read: {error.strerror or error}") from error
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(map(str, first["loc"])) or "the file"
        raise ValueError(
            f"{path} is not of format {FORMAT}: {where}: {first['msg'].lower()}"
        ) from error
