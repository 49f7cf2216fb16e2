"""Numbers and statements of Sects. 4 and 5: text and captions."""

from __future__ import annotations

from typing import Any

import sympy as sp

from references.errata import conductivity
from references.errata.algebra import names, particles_in_disc
from references.errata.model import Entry, Form, Verdict


def _limits() -> tuple[sp.Matrix]:
    """Ratio at which k22 of Eq. 163 vanishes, for n = 2, 4, 12, 34."""
    one, other = conductivity.MACRO[:2]
    return (sp.Matrix([sp.solve(conductivity.cosine_constants(n)[1], one)[0] / other
                       for n in (2, 4, 12, 34)]),)  # fmt: skip


def _beyond_the_eighth() -> dict[str, float]:
    """Share of cos^12's variation in its harmonics 10 and 12."""
    shares = {2 * k: float(sp.binomial(12, 6 + k)) ** 2 for k in range(1, 7)}
    beyond = shares[10] + shares[12]
    return {"share": 100 * (beyond / sum(shares.values())) ** 0.5}


def _dimensions() -> tuple[Any, Any, Any]:
    """Of k = K/(h delta^2), of f = k T/xi^2 and of W = K zeta^2."""
    watt, metre, kelvin = sp.symbols("W m K", positive=True)
    conductivity = watt / (metre * kelvin)
    micro = conductivity / metre**3
    return micro, micro * kelvin / metre**2, conductivity * (kelvin / metre) ** 2


_R, _O = Verdict.RIGHT, Verdict.OPEN

ENTRIES = [
    Entry("Sect. 4 (dimensions)", "dimensions of k_T, f_T and W_T", _R,
          (Form("(W/(m*K))/m**3"), Form("W/m**3/m**3"), Form("W*K/m**3")), _dimensions,
          lambda: {name: sp.Symbol(name, positive=True) for name in "WmK"},
          "Eqs. 153, 113 and 148: conductivity over volume, heat current over volume squared, "
          "entransy rate over volume"),
    Entry("Sect. 4.2 (limit)", "largest ratio of conductivities with k >= 0", _R,
          (Form("Matrix([n + 1 for n in powers])"),), _limits,
          lambda: names(powers=[sp.Integer(n) for n in (2, 4, 12, 34)]),
          "k22 = 0, for n = 2, 4, 12 and 34"),
    Entry("Sect. 4.2 (5 and 13)", "largest ratios for n = 4 and 12", _R,
          (Form("5"), Form("13")), lambda: (_limits()[0][1], _limits()[0][2]), names, "k22 = 0"),
    Entry("Sect. 4.2 (n = 12)", "the eighth-order law of [63] as n = 12", _O, (), tuple,
          needs="the law of that work",
          effect="cos^12 has harmonics 10 and 12 with {share:.1f} % of its variation: the two can "
          "be close, not the same", measure=_beyond_the_eighth),
    Entry("Sect. 4.3.1 (31428)", "particles of the disc at a/100", _R,
          (Form("31428", digits=True),), lambda: (particles_in_disc(100),),
          how="centres at half-integer multiples of the spacing"),
    Entry("Sect. 4.3.2 (ratio)", "ratio of resistivities", _R, (Form("3.2", digits=True),),
          lambda: (540 / 170,), how="540/170; n = 4 allows 5"),
    Entry("Sect. 4.3.2 (data)", "540 and 170 Ohm m", _O, (), tuple,
          needs="the measurements of the work cited"),
    Entry("Fig. 39 (stages)", "delta = 1, 1.03, 1.10, 1.16", _O, (), tuple,
          needs="what stands for delta: the potential drop over its first value, by Fig. 40, whose "
          "symbol may have been lost in extraction; the values are results of a run"),
    Entry("Figs. 40 and 41 (slopes)", "slopes of the potential drop", _O, (), tuple,
          needs="the figures' values: results of runs"),
]  # fmt: skip
