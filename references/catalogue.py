"""The stored references: what they are, with which arguments they are made, what they cite."""

from typing import Any

from references.generators import (
    MATERIALS,
    compact_tension_by_pins,
    compact_tension_growth,
    compact_tension_paths,
    crack_tip_samples,
    heated_disc_samples,
    kink_factors,
    notched_plate,
    pulled_plate_with_hole,
    square_modes,
    stress_intensity_table,
    tetrachiral_clamped,
    tetrachiral_free,
)
from references.generators_coupled import cracked_leads, strained_plate
from references.generators_dynamic import cracked_square_cools, free_plates, lamb_pulse
from references.provenance import Reference

_PAPER = "V. Diana, Anisotropic Continuum-Molecular Models, Arch. Comput. Methods Eng. (2022)"


def _kinks(material: str) -> Reference:
    degrees = [float(w) for w in range(-100, 101, 5)]
    if material in ("isotropic", "silicon"):  # mirror-symmetric in the crack's plane
        degrees = [w for w in degrees if w >= 0]
    return Reference(
        f"kinks-{material}",
        f"Stress intensity factors of a short kink, {material}",
        "M. Amestoy, J. B. Leblond, Int. J. Solids Struct. 29 (1992) 465 (isotropic); tensors: "
        + _PAPER,
        kink_factors,
        {"material": material, "degrees": degrees},
        spot={"degrees": degrees[4:5]},
        axis="degrees",
    )


def _strained(material: str, **arguments: Any) -> Reference:
    given = {"degrees": [0.0, 90.0], "gauge": 4.0, "probe": 1.6, "size": 0.02, "exponent": 4}
    return Reference(
        f"strained-plate-{material}",
        f"Piezoresistive plate with a hole under tension, {material}: drop and its change",
        _PAPER + ", Sect. 5; tensors: Eqs. 108, 173",
        strained_plate,
        {"material": material, **given, **arguments},
        spot={"degrees": [90.0]},
        axis="degrees",
    )


def _intensities(geometry: str, ratios: list[float], citation: str) -> Reference:
    return Reference(
        f"stress-intensity-{geometry}",
        f"Stress intensity factors, {geometry} crack, five materials",
        citation,
        stress_intensity_table,
        {
            "geometry": geometry,
            "ratios": ratios,
            "materials": list(MATERIALS),
            "elements": 24,
        },
        spot={"materials": ["anisotropic"], "ratios": ratios[1:2]},
        axis="ratios",
    )


def _plates() -> list[dict[str, Any]]:
    laminas = ([2.0, 1.0, 0.5, 0.3], [4.0, 1.0, 0.45, 0.25])
    return [
        {"nu": 0.3},
        {"nu": 0.45},
        *({"lamina": it, "degrees": angle} for it in laminas for angle in (0.0, 30.0, 45.0)),
        {"nu": 0.3, "feature": "hole"},
        {"nu": 0.3, "feature": "crack"},
    ]


def catalogue() -> dict[str, Reference]:
    """All stored references by name."""
    entries = [
        Reference(
            "tetrachiral-free",
            "Tetrachiral lattice, free frequencies: blocks, meshed interfaces, continuum (rad/s)",
            _PAPER + ", Sect. 2.4",
            tetrachiral_free,
            {"cells": [5, 9, 13, 25, 49], "count": 10},
            spot={"cells": [9, 25]},
            axis="cells",
        ),
        Reference(
            "tetrachiral-clamped",
            "Tetrachiral lattice, outer ring held, with the trend in the number of cells (rad/s)",
            _PAPER + ", Sect. 2.4",
            tetrachiral_clamped,
            {"cells": [9, 13, 25, 49, 97], "count": 10},
            spot={"cells": [9, 25]},
            axis="cells",
        ),
        _intensities(
            "centre", [0.2, 0.3, 0.4, 0.5, 0.6], "M. Isida, Int. J. Fract. Mech. 7 (1971) 301"
        ),
        _intensities(
            "edge",
            [0.2, 0.3, 0.4, 0.5, 0.6],
            "A. C. Kaya, F. Erdogan, Q. Appl. Math. 45 (1987) 105",
        ),
        _intensities("compact", [0.3, 0.4, 0.5, 0.6, 0.7], "ASTM E399"),
        _kinks("isotropic"),
        _kinks("silicon"),
        _kinks("anisotropic"),
        Reference(
            "crack-tip-disc",
            "Displacement of the crack-tip disc at the particles of spacing a/30",
            _PAPER + ", Sect. 2.3.1",
            crack_tip_samples,
            {"material": "anisotropic", "spacing": 1 / 30, "size": 0.03},
        ),
        Reference(
            "heated-disc",
            "Temperature exp(x − 2y) cos y in the disc at the particles of spacing a/25",
            _PAPER + ", Sect. 4.3.1",
            heated_disc_samples,
            {"spacing": 1 / 25, "size": 0.02},
        ),
        Reference(
            "square-modes",
            "Free and clamped frequencies of a fully anisotropic unit square",
            _PAPER + ", Sect. 2.3.1 (tensor)",
            square_modes,
            {"material": "anisotropic", "count": 10},
        ),
        Reference(
            "free-plates",
            "Free unit squares: isotropic, orthotropic and turned, with a hole, with a crack",
            "A. W. Leissa, NASA SP-160 (1969) (free plates); materials of this suite",
            free_plates,
            {
                "numbers": list(range(10)),
                "plates": _plates(),
                "count": 13,
                "hole": 0.2,
                "crack": 0.4,
                "elements": 40,
            },
            spot={"numbers": [3]},
            axis="numbers",
        ),
        Reference(
            "cracked-square-cools",
            "Insulated square with an edge crack between its warm and its cold half (K)",
            _PAPER + ", Sect. 4.3.1 (tensor)",
            cracked_square_cools,
            {
                "conductivity": [[5.0, 2.0], [2.0, 1.0]],
                "capacity": 2.0,
                "tip": 0.1,
                "duration": 0.05,
                "grids": [20, 40, 80],
                "size": 0.02,
                "steps": 200,
            },
        ),
        Reference(
            "lamb-pulse",
            "Edge of a half-plane under a strip of pressure, Ricker's wavelet (w μ / p λ_S)",
            "H. Lamb, Phil. Trans. R. Soc. A 203 (1904) 1; J. D. Achenbach, Wave Propagation in"
            " Elastic Solids (1973), ch. 7",
            lamb_pulse,
            {
                "receivers": [2.0, 3.0],
                "poisson": 0.2,
                "half_width": 0.1,
                "frequency": 1.0,
                "delay": 1.2,
                "end": 6.0,
                "instants": 121,
            },
            spot={"receivers": [2.0]},
            axis="receivers",
        ),
        *(
            Reference(
                f"plate-with-hole-{material}",
                f"Square plate with a hole pulled along axis 2, {material}",
                _PAPER + ", Sect. 3 (tensor)",
                pulled_plate_with_hole,
                {"material": material, "half_width": 4.0, "size": 0.01},
            )
            for material in ("isotropic", "bone", "anisotropic")
        ),
        Reference(
            "notched-plate",
            "Stiffness of the notched plate with a hole, rims held or rigid pins that turn (N/m²)",
            _PAPER + ", Fig. 21",
            notched_plate,
            {"unit": 5e-3, "young": 5.98e9, "poisson": 0.221, "size": 0.08},
        ),
        Reference(
            "compact-tension-pins",
            "Compact tension of cortical bone between rigid pins that turn: force and K a metre",
            _PAPER + ", Sect. 3.1.2; ASTM E399 (proportions)",
            compact_tension_by_pins,
            {
                "material": "bone",
                "degrees": [0.0, 45.0, 60.0, 90.0],
                "width": 25.8e-3,
                "ratio": 0.36,
                "elements": 20,
            },
        ),
        Reference(
            "bone-leads",
            "Compact specimen of bone between leads: drop over the length of a slit (V)",
            _PAPER + ", Sect. 4.3.2; ASTM E399 (proportions)",
            cracked_leads,
            {
                "width": 25.8e-3,
                "resistivities": [170.0, 540.0],
                "degrees": [0.0, 45.0, 90.0],
                "tips": [-3, 0, 3, 6, 9, 12, 15],
                "lead": [-24, 20, 3],
                "probe": [-24, 1, 2],
                "elements": 2,
            },
            spot={"degrees": [90.0]},
            axis="degrees",
        ),
        _strained("isotropic", resistivities=[1.0, 1.0], angle=0.0, resistive=False, actual=False),
        _strained("bone", resistivities=[170.0, 540.0], angle=0.5, resistive=True, actual=True),
        Reference(
            "compact-tension-growth",
            "The same with the fibres along the crack: force and K a metre by the crack's length",
            _PAPER + ", Sect. 3.1.2; ASTM E399 (proportions)",
            compact_tension_growth,
            {
                "material": "bone",
                "width": 25.8e-3,
                "ratios": [0.36, 0.4, 0.44, 0.48, 0.52],
                "elements": 16,
            },
        ),
        Reference(
            "compact-tension-paths",
            "The same with the fibres askew: where the crack goes by the energy criterion",
            _PAPER + ", Sect. 3.1.2; ASTM E399 (proportions)",
            compact_tension_paths,
            {
                "material": "bone",
                "degrees": [45.0, 60.0],
                "width": 25.8e-3,
                "ratio": 0.36,
                "energies": [2106.0, 989.0],
                "exponent": 8,
                "step": 1e-3,
                "steps": 4,
                "elements": 20,
            },
            spot={"degrees": [60.0]},
            axis="degrees",
        ),
    ]
    return {entry.name: entry for entry in entries}
