"""FEniCSx as a method of the study of work and precision: what scikit-fem solves, on its meshes.

Its seconds are taken within its own process, in which a problem is solved again and again: a first
time for the forms, which are compiled or loaded, then to be timed. Set-up is from arrays to
assembled equations and solve is MUMPS' LU where PETSc has it; what translates between two
numberings, and the start of the process, count as little as the making of meshes does.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from cmverify.case import Measurement, Method

#: Names of methods: "fem/P2" has "fenicsx/P2" beside it.
OURS, THEIRS = "fem/", "fenicsx/"


@dataclass(frozen=True)
class ByFenicsx:
    """What a method by scikit-fem measures, by FEniCSx.

    Attributes
    ----------
    method : Method
        Solves one problem of finite elements.
    """

    method: Method

    def __call__(self, n: int) -> Measurement:
        """Errors and memory, and times of one pass."""
        return self._run(n, 1)[0]

    def times(self, n: int, repeats: int) -> list[float]:
        """Seconds of set-up and solve of so many passes."""
        return self._run(n, repeats)[1]

    def _run(self, n: int, repeats: int) -> tuple[Measurement, list[float]]:
        """Repeat after a pass that does not count.

        Raises
        ------
        FenicsxError
            If there is no FEniCSx, or it fails.
        ValueError
            If the method solves no problem, or several.
        """
        from references.fem.listening import listening
        from references.fenicsx import again, bridge

        with bridge.timed(repeats + 1) as timing, listening(again.once):
            found = self.method.run(n)
        if len(timing.taken) != 1:
            raise ValueError(f"{self.method.name} solves {len(timing.taken)} problems, not one")
        taken = timing.taken[0]
        setup, solve = taken["setup"][1:], taken["solve"][1:]
        measured = replace(
            found,
            seconds={"setup": float(np.median(setup)), "solve": float(np.median(solve))},
            statistics={
                "method": "sparse LU, FEniCSx",
                "memory": int(taken["memory"]),
                "compiling": float(taken["forms"][0]),
            },
        )
        return measured, [float(total) for total in setup + solve]


def beside(methods: Sequence[Method]) -> tuple[Method, ...]:
    """The same finite elements by FEniCSx, of those that scikit-fem solves here."""
    return tuple(
        Method(
            method.name.replace(OURS, THEIRS, 1), "fem", ByFenicsx(method), method.resolutions,
            method.warm_up, method.problem,
        )
        for method in methods
        if method.kind == "fem" and method.name.startswith(f"{OURS}P")
    )  # fmt: skip
