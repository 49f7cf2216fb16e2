"""Numbers and statements of Sects. 1 and 2: text and captions."""

from __future__ import annotations

from functools import cache
from itertools import permutations, product
from typing import Any

import numpy as np
import sympy as sp

from references.errata import correspondence, crack_tip
from references.errata.algebra import names, particles_in_disc
from references.errata.model import Entry, Form, Verdict


def independent_moduli(dimension: int, central: bool) -> int:
    """Components C_ijkl that symmetry leaves, counted as orbits of the indices.

    The symmetries of an energy's second derivative, or all permutations (central forces between
    pairs make C_ijkl a sum of n_i n_j n_k n_l: Cauchy's relations).
    """
    energy = ((0, 1, 2, 3), (1, 0, 2, 3), (0, 1, 3, 2), (1, 0, 3, 2))
    allowed = tuple(permutations(range(4))) if central else energy + tuple(
        (p[2], p[3], p[0], p[1]) for p in energy
    )  # fmt: skip
    indices = product(range(dimension), repeat=4)
    return len({min(tuple(i[p] for p in order) for order in allowed) for i in indices})


def _positive(*tensors: list[list[float]]) -> tuple[list[int]]:
    return ([int(np.sign(np.linalg.eigvalsh(np.array(t))[0])) for t in tensors],)


def _positive_axial() -> tuple[list[int]]:
    """Sign of C1111 - C1212 for Poisson's ratios from -0.99 to 0.49, plane stress and strain."""
    signs = []
    for nu in (-0.99, 0.0, 0.49):
        shear = 1 / (2 * (1 + nu))
        for axial in (1 / (1 - nu**2), (1 - nu) / ((1 + nu) * (1 - 2 * nu))):
            signs.append(int(np.sign(axial - shear)))
    return (signs,)


def _poisson_range() -> tuple[Any, Any]:
    """Where the shear and the bulk modulus of an isotropic solid change their sign."""
    nu = sp.Symbol("nu")
    return sp.solve(1 + nu, nu)[0], sp.solve(1 - 2 * nu, nu)[0]


@cache
def shifted_counts() -> dict[str, float]:
    """Particles in a disc at a/120 for all placements of the grid to a fiftieth of a cell."""
    shifts = np.linspace(0.0, 0.5, 26)
    counts = [particles_in_disc(120, (p, q)) for p in shifts for q in shifts if p <= q]
    return {"least": min(counts), "most": max(counts)}


def _cell() -> tuple[Any, Any, Any]:
    """Pitch and contact of blocks turned by beta, tan beta = 1/2, that touch along their sides."""
    pitch, tan = sp.Symbol("pitch", positive=True), sp.Rational(1, 2)
    a, cos = sp.Symbol("a", positive=True), 1 / sp.sqrt(1 + sp.Rational(1, 4))
    # In a block's own axes the neighbour's centroid lies at (pitch cos, -pitch sin).
    touching = sp.solve(pitch * cos - a, pitch)[0]
    return touching, a - touching * cos * tan, touching


def _mesh() -> dict[str, float]:
    return {
        "elements": 115962 / 1200,
        "ratio": 380311 / 115962,
    }


_R, _W, _O = Verdict.RIGHT, Verdict.WRONG, Verdict.OPEN
_GIVEN = Verdict.DEFINITION


def _digits(number: str, title: str, printed: str, truth: Any, how: str, **more: Any) -> Entry:
    return Entry(number, title, _R, (Form(printed, digits=True),), lambda: (truth(),), how=how,
                 **more)  # fmt: skip


ENTRIES = [
    Entry("Sect. 1 (moduli)", "elastic constants of solids of central and of general pairs", _R,
          (Form("15"), Form("21")),
          lambda: (independent_moduli(3, True), independent_moduli(3, False)),
          how="orbits of the indices of C_ijkl", exact=False),
    Entry("Sect. 2.2 (six)", "elastic constants in the plane", _R, (Form("6"),),
          lambda: (independent_moduli(2, False),), how="orbits of the indices of C_ijkl",
          exact=False),
    Entry("Figs. 2 and 4 (solids)", "the solids of Figs. 2 and 4 are admissible", _R,
          (Form("[1, 1]"),),
          lambda: _positive([[1, 0.2, 0.1], [0.2, 1, 0.2], [0.1, 0.2, 1 / 3]],
                            [[1, 0.2, 0], [0.2, 1, 0], [0, 0, 1 / 3]]),
          how="sign of the smallest eigenvalue", exact=False),
    Entry("Sect. 2.2.1 (k_n)", "k_n of an isotropic solid is always positive", _R,
          (Form("[1, 1, 1, 1, 1, 1]"),), _positive_axial, how="nu = -0.99, 0, 0.49, both planes",
          exact=False),
    Entry("Fig. 3 (range)", "range of Poisson's ratio", _R, (Form("-1"), Form("1/2")),
          _poisson_range, names, "sign of shear and bulk modulus of a solid"),
    Entry("Sect. 2.2.1 (m)", "m > 3 for anisotropic elasticity", _O, (), tuple,
          effect="with the continuum's moduli the energy of a uniaxial strain errs by up to "
          "{m3:.1f} % at m = 3, {m4:.1f} % at m = 4, {m5:.1f} % at m = 5 over all turns of the "
          "solid", measure=correspondence.lattice_error,
          needs="which error is tolerated; Fig. 4 shows curves only"),
    Entry("Sect. 2.3.1 (solid)", "the anisotropic solid is admissible", _R, (Form("[1]"),),
          lambda: _positive(crack_tip.TENSOR.tolist()), how="sign of the smallest eigenvalue",
          exact=False),
    Entry("Sect. 2.3.1 (particles)", "particles of the crack-tip problem at a/120", _W,
          (Form("45344", "45244", off="100", digits=True),), lambda: (particles_in_disc(120),),
          how="centres at half-integer multiples of the spacing, which give the other three counts",
          readings=("the grid moved to any place: {least:.0f} to {most:.0f}",
                    "with the particles on the circle: none lies on it", "one digit: right"),
          effect="none; grids moved to any place give {least:.0f} to {most:.0f}",
          measure=shifted_counts),
    Entry("Sect. 2.3.1 (horizon)", "horizon of the crack-tip problem", _W,
          (Form("a/25", "a/24", off="-a/600"),),
          lambda: (5 * sp.Symbol("a", real=True) / 120,), lambda: names("a"),
          "m dx with m = 5, dx = a/120",
          ("m dx, the paper's definition of m: a/24, which is not below a/25",
           "(m + 1/2) dx, the reach of partial areas: larger still",
           "(m - 1/2) dx, where cells are full: a/26.7, but that is not the horizon"),
          "none in what follows"),
    _digits("Fig. 9 (a/60)", "particles at a/60", "11304", lambda: particles_in_disc(60),
            "centres at half-integer multiples of the spacing"),
    _digits("Fig. 9 (a/30)", "particles at a/30", "2828", lambda: particles_in_disc(30),
            "centres at half-integer multiples of the spacing"),
    Entry("Sect. 2.3.2 (cell)", "pitch and contact of the blocks", _R,
          (Form("a/(2/sqrt(5))"), Form("a/2")), lambda: _cell()[:2],
          lambda: names(a=sp.Symbol("a", positive=True)),
          "squares that touch along their sides, tan beta = 1/2"),
    Entry("Sect. 2.3.2 (horizon)", "delta = 5/4 a, said to be about the pitch", Verdict.INCOMPLETE,
          (Form("5/4*a", "sqrt(5)/2*a", off="5/4*a - sqrt(5)/2*a"),), lambda: _cell()[2:],
          lambda: names(a=sp.Symbol("a", positive=True)), "the pitch a/cos beta",
          ("to one digit: right", "a/cos^2 beta: 5a/4 exactly, but the pitch is a/cos beta",
           "the m-convergence runs to the solution of delta = 5a/4, not of delta = pitch"),
          "the horizon is {more:.1f} % larger than the pitch",
          lambda: {"more": 100 * (1.25 / (np.sqrt(5) / 2) - 1)}),
    Entry("Sect. 2.3.2 (mesh)", "380311 nodes and 115962 elements", _O, (), tuple,
          effect="{elements:.2f} elements for each of the 1200 interfaces: they are not meshed "
          "alike, or blocks are meshed too; {ratio:.2f} nodes an element is possible for "
          "quadrilaterals with eight nodes", measure=_mesh, needs="the mesh"),
    Entry("Sect. 2.3.2 (reduction)", "the horizon reduced eight times", _O, (), tuple,
          needs="the spacings of Fig. 11"),
    Entry("Fig. 12 (spacing)", "delta = 5/4 a with m = 5 on the square of 25 pitches",
          Verdict.INCOMPLETE, (Form("a/4", "25*sqrt(5)/224*a", off="a/4 - 25*sqrt(5)/224*a"),),
          lambda: (25 * _cell()[0] / 112,), lambda: names(a=sp.Symbol("a", positive=True)),
          "the side of 25 pitches in 112 cells",
          ("dx = a/4 exactly: the side is 111.80 cells, so that its edge is off by a part of one",
           "the nearest whole number of cells: right"),
          "a body of 112 cells of a/4 is {more:.2f} % larger, its frequencies that much lower",
          lambda: {"more": 100 * (112 / 4 / (25 * np.sqrt(5) / 2) - 1)}),
    Entry("Cross-references", "Eq. 51 after 57, 53 after 143, Sect. 4.2 after 142, Eq. 18 after "
          "22", Verdict.NOTATION, (), tuple, how="read",
          readings=("Eq. 55, Eq. 52, Sect. 2.2.1, Eqs. 17-18: what is meant",)),
    Entry("Sect. 2.3 (data)", "a = 20 mm, a/500, 25 x 25, tan beta = 1/2, E, nu, rho, m = 5",
          _GIVEN, (), tuple, how="chosen by the author; nothing to be right or wrong"),
]  # fmt: skip
