"""Numbers and statements of Sect. 3: text and captions."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from references.errata import cuts
from references.errata.algebra import particles_in_disc
from references.errata.model import Entry, Form, Verdict


def plate_with_holes(shift: float) -> int:
    """Cells of a plate of 13a x 24a at a/10 outside holes of radius a, a and 2a.

    The holes' centres lie on a corner of cells (shift 1/2) or on a particle (0); the notch is a
    cut that takes nothing away.
    """

    def hole(radius: int) -> int:
        span = np.arange(-radius - 1, radius + 2) + shift
        return int(np.count_nonzero(np.hypot(span[:, None], span[None, :]) < radius))

    return 130 * 240 - 2 * hole(10) - hole(20)


def _whole_square() -> tuple[int]:
    centres = (np.arange(-10, 260) + 0.5) / 240
    inside = np.count_nonzero((centres > 0) & (centres < 1))
    return (int(inside) ** 2,)


def _admissible() -> tuple[list[int]]:
    """Whether w_c >= 0 for the laws of Figs. 14, 16 (ratio 1.8; n = 2, 4, 8) and 18."""
    limits = [cuts.largest_ratio(n) - 1.8 for n in (2, 4, 8)]
    limits.append(cuts.largest_ratio(16, fourfold=True) - 1.25)
    return ([int(bool(limit > 0)) for limit in limits],)


@cache
def _products() -> dict[str, float]:
    """Grids of 12312 = p q cells of about 0.3 mm: the one nearest to a square, in mm."""
    p = max(k for k in range(1, 112) if 12312 % k == 0)
    return {"p": p, "q": 12312 // p, "height": 0.3 * p, "width": 0.3 * (12312 // p)}


_R, _O, _U = Verdict.RIGHT, Verdict.OPEN, Verdict.UNSAID


def _limit(number: str, printed: str, power: int, fourfold: bool = False,
           truncated: bool = False) -> Entry:  # fmt: skip
    return Entry(number, f"largest ratio of fracture energies, n = {power}", _R,
                 (Form(printed, digits=True, truncated=truncated),),
                 lambda: (float(cuts.largest_ratio(power, fourfold)),),
                 how="w_c2 = 0 in Eq. 92" + (", cut off" if truncated else ""))  # fmt: skip


def _open(number: str, title: str, needs: str, **more: Any) -> Entry:
    return Entry(number, title, _O, (), tuple, needs=needs, **more)


ENTRIES = [
    _limit("Sect. 3 (n = 2)", "2", 2),
    _limit("Sect. 3 (n = 8)", "3.65", 8, truncated=True),
    _limit("Sect. 3 (n = 32)", "7.14", 32, truncated=True),
    _limit("Sect. 3 (fourfold)", "1.2", 4, fourfold=True),
    Entry("Figs. 14, 16 and 18 (ratios)", "ratios 1.8 and 5/4 are admissible", _R,
          (Form("[1, 1, 1, 1]"),), _admissible, how="limits of the ratio, n = 2, 4, 8 and 16",
          exact=False),
    _open("Figs. 15 and 17 (ratios)", "ratios shown for n = 8", "the legends of the figures"),
    Entry("Sect. 3.1.1 (57600)", "particles of the inclusion problem", _R,
          (Form("57600", digits=True),), _whole_square, how="cells of the whole square at a/240",
          readings=("the square without the inclusion: {without:.0f}",
                    "the whole square, the inclusion's particles held: right"),
          measure=lambda: {"without": 240**2 - particles_in_disc(40)}),
    Entry("Sect. 3.1.1 (steps)", "step over the largest displacement", _U,
          (Form("0.005"),), lambda: (1e-4 / 0.02,), how="1e-4 mm over 0.02 mm",
          readings=("fixed steps: the stages 0.9920 ... 0.9929 of Fig. 20 lie within one",
                    "steps refined, as Sect. 3.1 says: right"), exact=False),
    Entry("Fig. 20 (labels)", "stages of Fig. 20", Verdict.NOTATION,
          (Form("[1, 2, 1, 1]", "[1, 2, 3, 4]", off="[0, 0, -2, -3]"),),
          lambda: (np.argsort(np.argsort([0.9920, 0.9926, 0.9927, 0.9929])) + 1,),
          how="order of the displacements", readings=("S.1 to S.4 in order: right",), exact=False),
    _open("Fig. 20 (stages)", "displacements of the stages, 0.9920 to 0.9929",
          "how steps are refined and how many bonds break at once: results of a run, which the "
          "inclusion problem of this suite measures"),
    Entry("Sect. 3.1.1 (29345)", "particles of the plate with holes", _U,
          (Form("29345", digits=True),), lambda: (plate_with_holes(0.0),),
          how="130 x 240 cells, holes of radius a, a, 2a centred on particles, the notch a cut",
          readings=("centres of the holes on corners of cells, where the plate's dimensions put "
                    "them: {corner:.0f}", "on particles: right"),
          effect="holes moved by half a cell ({corner:.0f} particles where they belong)",
          measure=lambda: {"corner": plate_with_holes(0.5)}),
    Entry("Fig. 22 (end)", "largest displacement, mm", _R, (Form("1.2", digits=True),),
          lambda: (1.201,), how="the last stage of Fig. 22, 1.201 mm, to the digits of the text"),
    _open("Figs. 22, 23 and 30 (stages)", "displacements at which cracks grow",
          "outline, rims and refinement of steps: results of runs"),
    Entry("Sect. 3.1.1 (data)", "E, nu, G, a, thickness of the first two problems",
          Verdict.DEFINITION, (), tuple, how="chosen by the author after the works cited"),
    _open("Figs. 25 to 27 (angles)", "kink angles", "the figures' values; the suite's kinking "
          "study holds its own against the hoop criterion"),
    _open("Sect. 3.1.2 (K)", "6.5 and 4.0 MPa m^(1/2)", "the measurements of the work cited"),
    _open("Sect. 3.1.2 (12312)", "particles of the compact specimen",
          "the outline: whether slot and holes are cut out, and how an almost uniform grid lies",
          effect="12312 = {p:.0f} x {q:.0f}; at 0.3 mm that is {height:.1f} x {width:.1f} mm, a "
          "full rectangle", measure=_products),
    _open("Sect. 3.1.2 (P)", "98 N and 96 N", "W of Fig. 28; with the 25.8 mm that belong to 98 N "
          "(Eq. 110) the two agree by construction. 96 N is the result of a run, 2 % below"),
]  # fmt: skip
