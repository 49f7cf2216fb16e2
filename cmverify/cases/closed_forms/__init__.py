"""The closed forms that judge everything else, judged by what they have to satisfy.

Derivatives are central differences of fourth order, energies and fluxes are integrated: nothing
of a formula is used to check it. A closed form that is wrong by a per cent in one of its parts
(displacement, stress, rotation, flux, source, a constant) breaks an identity here, before any
solver is compared with it.
"""

from __future__ import annotations

from collections.abc import Callable

from cmverify.case import Case, Check, Level, Measurement, Method
from cmverify.cases.closed_forms.constants import cracks, tensors, toughness
from cmverify.cases.closed_forms.elements import elements
from cmverify.cases.closed_forms.fields import conduction, crack_tip, hole, polynomials, waves

DIFFERENCES = "identity; differences of fourth order with a margin"
METHODS: dict[str, tuple[Callable[[int], Measurement], dict[str, float], str]] = {
    "crack tip": (
        crack_tip,
        {
            "Hooke": 1e-9, "balance": 1e-9, "gradient": 1e-9, "rotation": 1e-9, "edge": 1e-9,
            "K of the stress": 1e-9, "closure": 1e-6, "term of order 1": 1e-9, "interaction": 1e-3,
        },
        DIFFERENCES,
    ),
    "hole": (
        hole, dict.fromkeys(("Hooke", "balance", "edge", "far", "hoop"), 1e-9), DIFFERENCES
    ),
    "polynomials": (
        polynomials,
        dict.fromkeys(("Hooke", "balance", "rotation", "body force"), 1e-9),
        DIFFERENCES,
    ),
    "conduction": (
        conduction,
        {
            **dict.fromkeys(
                (
                    "gradient", "flux", "source", "printed source", "coefficient", "exponential",
                    "power", "pulse flux",
                ),
                1e-8,
            ),
            "rate": 1e-6, "storage": 1e-6, "heat": 2e-6,
        },
        DIFFERENCES,
    ),
    "toughness": (
        toughness,
        dict.fromkeys(("two lobes", "four lobes", "quadrature", "turned"), 1e-6),
        "a plain sum over angles",
    ),
    "tensors": (
        tensors,
        dict.fromkeys(
            ("turned energy", "plane stress", "plane strain", "speeds", "blocks", "interface"),
            1e-10,
        ),
        "definition",
    ),
    "waves": (
        waves,
        {"polarised": 1e-10, "half-plane": 1e-5, "Rayleigh": 1e-9},
        "balance of a plane wave; Rayleigh's integral in Laplace's transform",
    ),
    "finite elements": (
        elements,
        {
            **dict.fromkeys(("stress", "strain", "difference", "flux", "temperature"), 1e-10),
            "motion": 1e-8, "heat in time": 1e-9,
        },
        "linear fields are exact on any mesh",
    ),
    "cracks": (
        cracks,
        {
            "hoop factors": 1e-9, "mode II": 1e-3, "hoop maximum": 1e-3, "largest release": 0.2,
            "release at 0": 2e-3, "compact": 1e-3, "drop": 1e-6,
        },
        "isotropic bodies, maxima, ASTM E399, the far field",
    ),
}  # fmt: skip
QUANTITIES = {
    "Hooke": "stress against the stiffness times the differences of the displacement",
    "balance": "divergence of the stress over the size of its derivatives",
    "gradient": "gradient against differences",
    "rotation": "rotation against half the curl of the differences",
    "body force": "body force against the divergence of the stress",
    "K of the stress": "σ₂₂ √(2πr) and σ₁₂ √(2πr) ahead of the tip against K_I and K_II",
    "edge": "traction on the free edge, relative",
    "closure": "energy release rate against the work that closes the crack (Irwin)",
    "term of order 1": "the series' term of order 1 against the field of the tip",
    "interaction": "the interaction integral on a fine ring against the K prescribed",
    "far": "stress far from the hole against the remote one",
    "hoop": "hoop stress at the edge against the stress there",
    "flux": "flux against −D times differences",
    "source": "source against the divergence of the flux, over the size of its derivatives",
    "printed source": "the source that Eq. 169 as printed needs against 0.8 x₂",
    "coefficient": "difference of the cubics with x₂³/3 and x₂³/5",
    "exponential": "exp(x₁ − 2x₂) cos x₂ itself",
    "power": "flux through a circle about a point source against its power",
    "heat": "heat of a pulse over the plane against what was released",
    "rate": "rate of a pulse's temperature against differences in time",
    "storage": "divergence of the pulse's flux against ρc times that rate",
    "pulse flux": "flux of a pulse against −D times differences",
    "two lobes": "what cuts along and across cost with the constants of Eqs. 97–99",
    "four lobes": "the same with those of Eq. 103",
    "quadrature": "Eq. 92 by threefold quadrature",
    "turned": "the law's effective fracture energy at other angles",
    "turned energy": "energy of a strain in turned axes",
    "plane stress": "strains of an isotropic solid under uniaxial stress, plane stress",
    "plane strain": "the same in plane strain",
    "speeds": "squares of the wave speeds of an isotropic solid",
    "polarised": "traction of a plane wave against ρ c² times its displacement",
    "half-plane": "Laplace transform of Lamb's edge displacement against Rayleigh's integral",
    "Rayleigh": "Rayleigh's determinant at the speed of his wave",
    "blocks": "Eqs. 87–90 against the homogenised cell of the rigid-block lattice",
    "interface": "Eq. 86 for round numbers",
    "hoop factors": "hoop factors of mode I in an isotropic body against cos³(ω/2)",
    "mode II": "hoop kink angle of mode II against −70.53° in an isotropic body, degrees",
    "hoop maximum": "shear factor in the direction of the largest hoop factor, over that",
    "largest release": "distance of the stored table's maximum from that of a parabola, degrees",
    "release at 0": "the stored table's release rate without a kink against the closed form",
    "compact": "shape factor of the compact specimen at a/W = 1/2 against ASTM E399's 9.66",
    "stress": "stress of finite elements under the tractions of a homogeneous one",
    "strain": "its strain",
    "difference": "differences of its displacement, rigid motions aside",
    "temperature": "temperature of finite elements, linear field",
    "motion": "displacement of damped finite elements that grows with the square of time",
    "heat in time": "temperature of finite elements that grows with time",
    "drop": "Johnson's potential drop far from the crack",
}
CASES = (
    Case(
        name="closed-forms",
        title="Closed forms and stored tables, by identities",
        section="Sects. 2.3, 3 and 4.3",
        tags=("references",),
        shows=(
            "What judges the solver satisfies its own equations: displacement, stress, rotation, "
            "flux and source of every closed form belong together, and their constants are right."
        ),
        methods=tuple(
            Method(f"reference/{name}", "exact", run, dict.fromkeys(Level, (1,)))
            for name, (run, _, _) in METHODS.items()
        ),
        checks=tuple(
            Check(f"reference/{name}", quantity, {1: bound}, source=source, exact=True)
            for name, (_, bounds, source) in METHODS.items()
            for quantity, bound in bounds.items()
        ),
        quantities=QUANTITIES,
        primary="Hooke",
        featured="reference/crack tip",
        length="a",
        timed=False,
    ),
)
