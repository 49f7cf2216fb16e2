"""What a scene file asks for, ready to be done."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from cmverify.exchange.budget import Cost
from cmverify.exchange.model import SceneFile
from cmverify.exchange.output import Selected
from cmverify.exchange.refusal import Place, Source
from cmverify.exchange.values import InTime

if TYPE_CHECKING:
    from solver import Scene
    from solver.result import Result


@dataclass(frozen=True)
class Request:
    """A scene file that has been read.

    Attributes
    ----------
    source : Source
        To say where something is wrong.
    file : SceneFile
    scene : Scene
    analysis : str
        What is done with it.
    options : dict
        Keywords of the analysis.
    cost : Cost
        What setting it up and solving it once will take.
    """

    source: Source
    file: SceneFile
    scene: Scene
    analysis: str
    options: dict[str, Any]
    cost: Cost

    def run(self, progress: Callable[[float], None] | None = None) -> Result:
        """Do what the file asks for.

        Parameters
        ----------
        progress : callable, optional
            Told the share that is done, if the analysis knows it.

        Raises
        ------
        SceneFileError
            If the physics says no.
        """
        from solver.analyses import analyses

        analysis, options = analyses()[self.analysis], dict(self.options)
        if progress is not None and analysis.reports:
            options["progress"] = progress
        with self._refused():
            whole = analysis.run(self.scene, **options)
        if not self.file.output.model_fields_set:
            return whole
        return Selected(whole, self.file.output, self.scene.spacing)

    @contextmanager
    def _refused(self) -> Iterator[None]:
        """What the solver refuses, with the table that it is about."""
        try:
            yield
        except (ValueError, RuntimeError, ArithmeticError, np.linalg.LinAlgError) as error:
            raise self.source.error(self._place(error), str(error)) from error
        except MemoryError as error:
            message = "the scene does not fit into memory: take a larger spacing or a smaller m"
            raise self.source.error(("discretisation",), message) from error

    def _place(self, error: Exception) -> Place:
        import solver

        message = str(error)
        for number, crack in enumerate(self.scene.cracks):
            if str(crack.points) in message:
                return ("crack", number)
        for place, value in timed(self.file):
            if any(repr(text) in message for text in value.texts):
                return place
        table = self.source.data.get(self.analysis, {})
        for key in table:
            if re.search(rf"\b{re.escape(key)}\b", message):
                return (self.analysis, key)
        if isinstance(error, solver.ToughnessError):
            return (self.analysis,)
        kinds: list[tuple[type[Exception], Place]] = [
            (solver.MechanismError, ("support",)),
            (solver.CalibrationError, ("material",)),
            (solver.InadmissibleMaterialError, ("material",)),
            (solver.ConvergenceError, ("solve", "tolerance")),
            (solver.NegativeCurvatureError, ("material",)),
        ]
        for kind, place in kinds:
            if isinstance(error, kind):
                # A body that nothing holds has no table of supports to point to.
                return place if place[0] in self.source.data else ("discretisation",)
        # What an analysis says of itself, such as of its electrodes, is in its table.
        return (self.analysis,) if self.analysis in self.source.data else ("discretisation",)


def timed(file: SceneFile) -> Iterator[tuple[Place, InTime]]:
    """Values that depend on time, with their places."""
    for i, support in enumerate(file.support):
        for name, value in support.values.items():
            if isinstance(value, InTime):
                yield ("support", i, name), value
    for i, load in enumerate(file.load):
        if isinstance(load.value, InTime):
            yield ("load", i, "value"), load.value
