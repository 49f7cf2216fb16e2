"""Manufactured solutions: fields chosen first, the loads that they need derived from them by SymPy.

No field here solves the equations without its loads, so that body forces, heat sources, inertia,
heat capacity and thermal strain are all at work inside the body. An anisotropic square holds them
outside an inner square, in a layer of whole families at least. Spacings go down by three, so that
the first held row is the same line on every lattice: second order at a fixed m.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import sympy as sp

from cmverify.judge.convergence import observed_orders
from cmverify.judge.norms import relative_l2
from solver import ConductivityTensor, ElasticTensor, ExpansionTensor, Load, Scene, Support
from solver import rectangle as box
from solver.analyses import transient, waves

X, Y, T = sp.symbols("x y t", real=True)
C = np.array([[1.0, 0.2, 0.1], [0.2, 0.8, 1 / 6], [0.1, 1 / 6, 1 / 3]])
D = np.array([[5.0, 2.0], [2.0, 1.0]])
A = np.array([[1.5, 0.5], [0.5, -1.0]])
DENSITY, CAPACITY = 1.3, 0.7
M = 3
#: From where on values are held: the fifth row from the middle at a/16.
HELD = 4.5 / 16
#: A displacement and a temperature without any symmetry, in units of what they are small beside.
U = (sp.sin(2 * X + Y) + X * Y**2, sp.cos(X - 3 * Y) - X**3)
HEAT = sp.exp(X - 2 * Y) + sp.sin(3 * X * Y)


def rational(matrix: np.ndarray) -> sp.Matrix:
    return sp.Matrix(matrix.tolist())


def divergence_of_stress(u, warm=0) -> list[sp.Expr]:
    """div C : (ε(u) − A T)."""
    strain = sp.Matrix(
        [sp.diff(u[0], X), sp.diff(u[1], Y), sp.diff(u[0], Y) + sp.diff(u[1], X)]
    ) - warm * sp.Matrix([A[0, 0], A[1, 1], 2 * A[0, 1]])
    s = rational(C) * strain
    return [sp.diff(s[0], X) + sp.diff(s[2], Y), sp.diff(s[2], X) + sp.diff(s[1], Y)]


def conducted(temperature) -> sp.Expr:
    """div D ∇T."""
    flux = rational(D) * sp.Matrix([sp.diff(temperature, X), sp.diff(temperature, Y)])
    return sp.diff(flux[0], X) + sp.diff(flux[1], Y)


def rotation(u) -> sp.Expr:
    return (sp.diff(u[1], X) - sp.diff(u[0], Y)) / 2


def function(expression, in_time: bool = False):
    """Of (x, y) or (x, y, t); pairs become (n, 2)."""
    parts = list(expression) if isinstance(expression, tuple | list) else [expression]
    made = [sp.lambdify((X, Y, T), part, "numpy") for part in parts]

    def value(x, y, t=0.0):
        columns = [np.broadcast_to(part(x, y, t), np.shape(x)) for part in made]
        return np.stack(columns, axis=-1) if len(columns) > 1 else columns[0]

    if in_time:
        return lambda x, y, t: value(x, y, t)
    return lambda x, y: value(x, y)


def outside(x, y):
    return np.maximum(np.abs(x), np.abs(y)) > HELD * (1 - 1e-9)


def elastic(n: int, u, force, in_time: bool = False, loads=(), **more) -> Scene:
    held = {"displacement": function(u, in_time), "rotation": function(rotation(u), in_time)}
    return Scene(
        region=box(1.0, 1.0), spacing=1.0 / n, m=M, material=ElasticTensor(C),
        supports=[Support.where(outside, **held)],
        loads=[Load.body_force(function(force, in_time)), *loads], **more,
    )  # fmt: skip


def conductor(n: int, temperature, source, in_time: bool = False, **more) -> Scene:
    return Scene(
        region=box(1.0, 1.0), spacing=1.0 / n, m=M, material=ConductivityTensor(D),
        supports=[Support.where(outside, temperature=function(temperature, in_time))],
        loads=[Load.source(function(source, in_time))], **more,
    )  # fmt: skip


def error(found, expression, solution, t: float = 0.0) -> float:
    free = ~outside(*solution.points.T)
    x, y = solution.points[free].T
    parts = expression if isinstance(expression, tuple | list) else (expression,)
    exact = function([part.subs(T, t) for part in parts])(x, y)
    return relative_l2(found[free], exact)


def statics(n: int, off: float = 1.0) -> float:
    force = [-off * part for part in divergence_of_stress(U)]
    solution = elastic(n, U, force).solve(tolerance=1e-11)
    return error(solution.displacement, U, solution)


def steady(n: int, off: float = 1.0) -> float:
    solution = conductor(n, HEAT, -off * conducted(HEAT)).solve(tolerance=1e-11)
    return error(solution.temperature, HEAT, solution)


def warmed(n: int, off: float = 1.0) -> float:
    """The temperature is itself a solution of the lattice, and strains the body."""
    heat = conductor(n, HEAT, -conducted(HEAT)).solve(tolerance=1e-11)
    strained = Load.temperature(off * heat.temperature, ExpansionTensor(A))
    force = [-part for part in divergence_of_stress(U, HEAT)]
    solution = elastic(n, U, force, loads=[strained]).solve(tolerance=1e-11)
    return error(solution.displacement, U, solution)


def cooling(n: int, off: float = 1.0) -> float:
    end, field = 0.2, HEAT * sp.exp(-2 * T) + X * T
    source = CAPACITY * sp.diff(field, T) - conducted(field)
    scene = conductor(n, field, source, True, heat_capacity=off * CAPACITY)
    run = transient.run(scene, function(field.subs(T, 0)), [end], tolerance=1e-7)
    return error(run.temperature[-1], field, run, end)


def shaken(n: int, off: float = 1.0) -> float:
    end, u = 0.6, tuple(part * sp.cos(3 * T) for part in U)
    inner = divergence_of_stress(u)
    force = [DENSITY * sp.diff(p, T, 2) - s for p, s in zip(u, inner, strict=True)]
    scene = elastic(n, u, force, True, density=off * DENSITY)
    run = waves.run(scene, function([p.subs(T, 0) for p in u]), end)
    return error(run.displacement[-1], u, run, end)


PROBLEMS = {"statics": statics, "steady heat": steady, "heat that strains": warmed,
            "heat in time": cooling, "motion": shaken}  # fmt: skip


@cache
def measured(name: str, n: int) -> float:
    return PROBLEMS[name](n)


@pytest.mark.parametrize(
    "ns", [(16, 48), pytest.param((16, 48, 144), marks=pytest.mark.slow)], ids=["coarse", "fine"]
)
@pytest.mark.parametrize("name", PROBLEMS)
def test_second_order_with_the_loads_that_the_field_needs(name, ns):
    errors = [measured(name, n) for n in ns]
    orders = observed_orders(1.0 / np.array(ns), errors)
    assert all(1.7 <= order <= 2.6 for order in orders), (errors, orders)
    assert errors[-1] < 2e-3


@pytest.mark.parametrize("name", PROBLEMS)
def test_one_per_cent_of_what_the_loads_are_made_of_is_seen(name):
    """With one sign at least: with the other it may happen to make up for the lattice's error."""
    worse = max(PROBLEMS[name](48, off) for off in (0.99, 1.01))
    assert worse > 1.5 * measured(name, 48)
