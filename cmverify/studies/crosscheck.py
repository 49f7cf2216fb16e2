"""FEniCSx beside scikit-fem: the finite elements that judge the solver, solved by another code.

What a case owes to finite elements is solved by both: the problems that it names as
`Case.elements`, or else its methods of kind "fem" at the coarsest resolution. On the same mesh
both solve the same equations, and differ by rounding. On a mesh with each triangle cut in four
FEniCSx tells what the first mesh is worth.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from cmverify.case import Case, Level, Measurement

if TYPE_CHECKING:
    from references.fenicsx.again import Second

#: Two direct solvers on one mesh: 2e-14 to 5e-12 were measured.
SAME = 1e-9
#: A reference that changes by more if its mesh is halved judges nothing: 2e-3 at most, and 0.02
#: with uniform elements around a crack's tip, were measured on the small meshes used here.
CHANGE = 0.03


@dataclass(frozen=True)
class Row:
    """One problem by both codes.

    Attributes
    ----------
    case, problem : str
        The problem is a method with its resolution, or a name of `Case.elements`.
    solver : str
        What is solved, in words.
    order, nodes, finer_nodes : int
        Of the elements, and vertices of both meshes.
    difference, change : float
        Of FEniCSx on the same mesh and on the finer one from scikit-fem, over the largest value.
    quantity : str
        The case's main figure, if the problem's method measures it, else empty.
    ours, theirs, finer : float or None
        It by scikit-fem, by FEniCSx, and by FEniCSx on the finer mesh.
    seconds : float
        That FEniCSx took, its start included.
    failure : str
        Why there is nothing to compare; empty if there is.
    made : str
        By which FEniCSx, and when, where that is another run than the rest's.
    """

    case: str
    problem: str
    solver: str = ""
    order: int = 0
    nodes: int = 0
    finer_nodes: int = 0
    difference: float | None = None
    change: float | None = None
    quantity: str = ""
    ours: float | None = None
    theirs: float | None = None
    finer: float | None = None
    seconds: float = 0.0
    failure: str = ""
    made: str = ""

    @property
    def passed(self) -> bool:
        """Whether both codes agree and the finer mesh changes little; an error must fall on it."""
        if self.failure or self.difference is None or self.change is None:
            return False
        falls = True
        if self.theirs is not None and self.finer is not None:
            falls = self.finer < max(self.theirs, SAME)  # what is exact stays at rounding
        return bool(self.difference < SAME and self.change < CHANGE and falls)


#: What the solvers of `references.fem` solve.
SOLVED = {
    "solve_elasticity": "elasticity",
    "steady_conduction": "steady heat",
    "transient_conduction": "transient heat",
    "in_plane_modes": "modes",
    "plate_between_leads": "conduction between leads",
    "strained_conduction": "conduction of a strained body",
    "solve": "several solids",
}


def rows(
    cases: Sequence[Case], level: Level, listen: Callable[[str], None] = lambda text: None
) -> list[Row]:
    """Solve the finite elements of these cases by both codes.

    A problem that one of them cannot solve becomes a row that says so, and fails.
    """
    found = []
    for case in cases:
        for method in case.methods if not case.elements else ():
            ladder = method.resolutions.get(level, ())
            if method.kind == "fem" and ladder:
                listen(f"{case.name} {method.name}")
                found += _of_method(case, method.name, min(ladder))
        for name, solve in case.elements.items():
            listen(f"{case.name} {name}")
            found += _of_problem(case, name, solve)
    return found


def _of_problem(case: Case, name: str, solve: Callable[[], Any]) -> list[Row]:
    from references.fem.listening import listening
    from references.fenicsx.again import Beside, EnoughError

    ear, begun = Beside(once=True), time.perf_counter()
    try:
        with listening(ear):
            solve()
    except EnoughError:
        pass
    except Exception as error:
        return [Row(case.name, name, failure=f"{type(error).__name__}: {error}")]
    if not ear.found:
        return [Row(case.name, name, failure="no finite elements were solved")]
    spent = (time.perf_counter() - begun) / len(ear.found)
    return [_row(case.name, name, second, spent) for second in ear.found]


def _of_method(case: Case, name: str, n: int) -> list[Row]:
    """What a method solves, and its main figure with either code's answers."""
    from references.fem.listening import listening
    from references.fenicsx.again import Beside, Replay

    method, ear, begun = case.method(name), Beside(), time.perf_counter()
    problem = f"{name}, {case.length}/{n}"
    try:
        with listening(ear):
            ours = _figure(case, method.run(n))
        if not ear.found:  # stored figures, or a lattice of blocks
            return []
        with listening(Replay([second.same for second in ear.found])):
            theirs = _figure(case, method.run(n))
        with listening(Replay([second.finer for second in ear.found])):
            finer = _figure(case, method.run(n))
    except Exception as error:
        return [Row(case.name, problem, failure=f"{type(error).__name__}: {error}")]
    spent = (time.perf_counter() - begun) / len(ear.found)
    figures = (case.primary, ours, theirs, finer) if ours is not None else ("", None, None, None)
    return [_row(case.name, problem, second, spent, figures) for second in ear.found]


def _figure(case: Case, measurement: Measurement) -> float | None:
    value = measurement.quantities.get(case.primary)
    return None if value is None else float(value)


def _row(
    case: str,
    problem: str,
    second: Second,
    seconds: float,
    figures: tuple[str, float | None, float | None, float | None] = ("", None, None, None),
) -> Row:
    heard = second.heard
    order = heard.arguments.get("order", getattr(heard.answer, "order", 2))
    return Row(
        case, problem, SOLVED[heard.solver], order, second.nodes, second.finer_nodes,
        second.difference, second.change, *figures, seconds=seconds,
    )  # fmt: skip
