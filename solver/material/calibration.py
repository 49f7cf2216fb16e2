r"""Calibration: bond moduli whose sum over the family is the macroscopic tensor.

For a homogeneous strain ε with no rotation a bond stretches by s = v_s·ε and shears by
γ = v_γ·ε, v_s = (c², s², cs), v_γ = (−cs, cs, (c² − s²)/2) against (ε11, ε22, 2ε12) (Eqs. 52–54),
so the energy per volume of a bulk particle makes the lattice an elastic solid of

    C = ½ Σ α Λ |ξ| Δv (k_n v_s v_sᵀ + k_t v_γ v_γᵀ),        D = ½ Σ α Λ Δv k n nᵀ

(conduction has no |ξ|, Eq. 112). A polar solid's bending stiffness E = ½ Σ α Λ |ξ| Δv k_b n nᵀ
has the same law as a conductivity (Eqs. 179–181). Three calibrations choose the moduli:

``continuum``
    The paper's: the sum replaced by the integral over the horizon disc (Eqs. 58–70, 149–155,
    163–167). On a lattice C and D then come out wrong by a few per cent, at any spacing.
``lattice``
    The same angular law, coefficients from the sums themselves: exact.
``positive``
    Non-negative moduli with exact sums, nearest (in relative least squares) to the smooth law;
    in elasticity subject also to Σ α Λ |ξ| k_t v_γ = 0, which keeps rotation and homogeneous
    strain apart.

**Chiral solids** (`ChiralTensor`). With γ = v_γ·ε − φ, φ = θ − ω, bonds of the energy
½ |ξ| (k_n s² + 2 k_nt s γ + k_t γ²) make, w = ½ α Λ |ξ| Δv,

    C' = Σ w (k_n v_s v_sᵀ + k_t v_γ v_γᵀ + k_nt (v_s v_γᵀ + v_γ v_sᵀ)),
    c = Σ w (k_t v_γ + k_nt v_s),     Σ w k_t = 4 (C'66 − C'12) = 4 μ_c,

the last because v_γ6² − v_γ1 v_γ2 = ¼ while v_s6² = v_s1 v_s2 and the mixed products cancel, in
every direction. W = ½ ε·C'ε − φ c·ε + ½ 4 μ_c φ² is least at φ = r·ε with c = 4 μ_c r, and leaves
C = C' − 4 μ_c r rᵀ; so C66 − C12 = μ_c (1 + 4 (r1 r2 − r3²)): C and r fix μ_c, C' and c, nine sums.
k_n and k_t follow their law with six coefficients, k_nt has the harmonics 0 and 2. Without k_nt a
dilation ε = (1, 1, 0) couples to nothing (v_γ·ε = 0 in every bond); with it c1 + c2 = Σ w k_nt.
"""

from __future__ import annotations

from functools import singledispatch
from typing import Literal, get_args

import numpy as np

from ..arrays import Array
from ..errors import CalibrationError, NotRepresentableError
from .family import Family
from .laws import AngularLaw, Cosine, TwoHarmonic, UniformShear
from .moduli import (
    PAIRS2,
    PAIRS3,
    ChiralModuli,
    ConductiveModuli,
    ElasticModuli,
    ElectricModuli,
    Moduli,
    PolarModuli,
    bond_weights,
    conductive_moments,
    elastic_moments,
    stretch_rows,
)
from .positive import closest, feasible
from .tensors import (
    ChiralTensor,
    ConductivityTensor,
    ElasticTensor,
    ElectricConductivityTensor,
    GradientTensor,
    Material,
    PolarTensor,
)

Calibration = Literal["continuum", "lattice", "positive"]

# Largest relative error of the moments with which a law still counts as exact.
_EXACT = 1e-10
# A shear modulus below this share of the largest axial one is rounding.
_NO_SHEAR = 1e-12


def calibrate(
    family: Family,
    material: Material,
    calibration: Calibration = "lattice",
    law: AngularLaw | None = None,
) -> Moduli:
    """Bond moduli of `material` on `family`.

    Parameters
    ----------
    family : Family
    material : ElasticTensor or ConductivityTensor
    calibration : {"continuum", "lattice", "positive"}
    law : TwoHarmonic, UniformShear, Cosine or Fourfold, optional
        By default Cosine in conduction and the paper's two-harmonic law in elasticity, but for
        ``lattice`` UniformShear where the two-harmonic k_t would take both signs (its rotation
        block could then be singular).

    Returns
    -------
    ElasticModuli or ConductiveModuli

    Raises
    ------
    CalibrationError
        If the law has no member with the tensor's moments, or no non-negative moduli exist for
        the tensor at all.
    NotRepresentableError
        If they exist, but not on this family. `solver.material.admission.calibrated` says what
        would do instead.
    """
    if calibration not in get_args(Calibration):
        raise ValueError(
            f"unknown calibration {calibration!r}; known: {', '.join(get_args(Calibration))}"
        )
    return _calibrated(material, family, calibration, law)


@singledispatch
def _calibrated(
    material: Material, family: Family, calibration: Calibration, law: AngularLaw | None
) -> Moduli:
    raise TypeError(f"no calibration is known for a {type(material).__name__}")


@_calibrated.register
def _(
    material: ElasticTensor, family: Family, calibration: Calibration, law: AngularLaw | None
) -> Moduli:
    moduli = _elastic(family, material, calibration, TwoHarmonic() if law is None else law)
    mixed = moduli.shear.min() < 0 < moduli.shear.max()
    if law is None and calibration == "lattice" and mixed:
        return _elastic(family, material, calibration, UniformShear())
    return moduli


@_calibrated.register
def _(
    material: PolarTensor, family: Family, calibration: Calibration, law: AngularLaw | None
) -> Moduli:
    plain = _calibrated(ElasticTensor(material.voigt), family, calibration, law)
    assert isinstance(plain, ElasticModuli)
    bending = _conductive(family, material.bending, calibration, _of_gradients(law))
    return PolarModuli(plain.normal, plain.shear, bending)


@_calibrated.register
def _(
    material: ChiralTensor, family: Family, calibration: Calibration, law: AngularLaw | None
) -> Moduli:
    if calibration != "lattice":
        raise CalibrationError(
            f"chiral solids have a lattice calibration only, none called {calibration!r}"
        )
    moduli = _chiral(family, material, TwoHarmonic() if law is None else law)
    if law is None and moduli.shear.min() < 0 < moduli.shear.max():
        return _chiral(family, material, UniformShear())
    return moduli


def _chiral(family: Family, material: ChiralTensor, law: AngularLaw) -> ChiralModuli:
    psi, weight = family.angle, bond_weights(family, material)
    plain = ElasticTensor(material.unturned)
    basis_n, basis_t = law.elastic(psi, plain)
    basis_x = np.stack([np.ones_like(psi), np.cos(2 * psi), np.sin(2 * psi)])
    stretch, shear = stretch_rows(psi)
    a, b = PAIRS3
    moments_n, moments_t = elastic_moments(psi)
    mixed = stretch[a] * shear[b] + shear[a] * stretch[b]
    # Six moments of C' and three of c, by the law's coefficients and those of k_nt.
    of_law = [
        (weight * moments_n) @ basis_n.T + (weight * moments_t) @ basis_t.T,
        (weight * shear) @ basis_t.T,
    ]
    of_cross = [(weight * mixed) @ basis_x.T, (weight * stretch) @ basis_x.T]
    system = np.hstack([np.vstack(of_law), np.vstack(of_cross)])
    target = np.concatenate([plain.voigt[PAIRS3], material.coupling])
    found = _solve(system, target, f"{type(law).__name__} law (lattice, chiral)")
    count = len(basis_n)
    return ChiralModuli(
        _mirrored(found[:count] @ basis_n),
        _mirrored(found[:count] @ basis_t),
        _mirrored(found[count:] @ basis_x),
    )


def _of_gradients(law: AngularLaw | None) -> AngularLaw:
    """The law of k_b beside that of k_n and k_t: the same cosine, or the paper's (Eq. 179)."""
    return law if isinstance(law, Cosine) else Cosine()


@_calibrated.register
def _(
    material: ConductivityTensor, family: Family, calibration: Calibration, law: AngularLaw | None
) -> Moduli:
    return ConductiveModuli(
        _conductive(family, material, calibration, Cosine() if law is None else law)
    )


@_calibrated.register
def _(
    material: ElectricConductivityTensor,
    family: Family,
    calibration: Calibration,
    law: AngularLaw | None,
) -> Moduli:
    return ElectricModuli(
        _conductive(family, material, calibration, Cosine() if law is None else law)
    )


def _solve(system: Array, target: Array, what: str) -> Array:
    """Smallest coefficients with the wanted moments."""
    scale = np.abs(system).max(axis=0)
    scale[scale == 0] = 1.0
    coefficients: Array = np.linalg.lstsq(system / scale, target, rcond=1e-12)[0] / scale
    error = np.abs(system @ coefficients - target).max()
    if error > _EXACT * np.abs(target).max():
        raise CalibrationError(
            f"no {what} has the moments of this tensor (relative error of the best fit "
            f"{error / np.abs(target).max():.1e}): the law lacks its symmetry, or "
            f"the family has too few bond directions (a larger m has more)"
        )
    return coefficients


def _circle(law: AngularLaw) -> Array:
    """Angles whose equal-weight mean is exact for the law times two direction pairs."""
    count = 4 * (law.degree + 8)
    return np.linspace(0.0, 2 * np.pi, count, endpoint=False)


def _elastic(
    family: Family,
    material: ElasticTensor,
    calibration: Calibration,
    law: AngularLaw,
) -> ElasticModuli:
    target = material.voigt[PAIRS3]
    psi = family.angle
    weight = bond_weights(family, material)
    name = type(law).__name__
    if calibration == "lattice":
        basis_n, basis_t = law.elastic(psi, material)
        moments_n, moments_t = elastic_moments(psi)
        system = (weight * moments_n) @ basis_n.T + (weight * moments_t) @ basis_t.T
    else:
        circle = _circle(law)
        basis_n, basis_t = law.elastic(circle, material)
        moments_n, moments_t = elastic_moments(circle)
        radial = 0.5 * family.horizon**3 * family.influence.moment(2)
        mean = 2 * np.pi / len(circle)
        system = radial * mean * (moments_n @ basis_n.T + moments_t @ basis_t.T)
    coefficients = _solve(system, target, f"{name} law ({calibration})")
    basis_n, basis_t = law.elastic(psi, material)
    normal, shear = coefficients @ basis_n, coefficients @ basis_t
    if calibration == "positive":
        normal, shear = _positive_elastic(family, material, normal, shear)
    # Rounding must not give rotations a stiffness that no bond has (ν = 1/3 in plane stress).
    tiny = _NO_SHEAR * np.abs(normal).max()
    if np.abs(shear).max() <= tiny:
        shear = np.zeros_like(shear)
    return ElasticModuli(_mirrored(normal), _mirrored(shear))


def _positive_elastic(
    family: Family, material: ElasticTensor, normal: Array, shear: Array
) -> tuple[Array, Array]:
    c = material.voigt
    difference = c[2, 2] - c[0, 1]
    if difference < -1e-12 * np.abs(c).max():
        raise CalibrationError(
            f"no non-negative bond moduli exist for this solid at any m: their shear parts sum to "
            f"4 (C66 − C12) = {4 * difference:.6g} < 0 (ν > 1/3 for an isotropic solid in plane "
            f"stress)"
        )
    half = family.size // 2
    scale_n = np.maximum(np.abs(normal[:half]), 0.05 * np.abs(normal).max())
    scale_t = np.maximum(np.abs(shear[:half]), 0.05 * np.abs(normal).max())
    scale = np.concatenate([scale_n, scale_t])
    moments, target = _positive_system(family, material)
    wanted = np.concatenate([normal[:half], shear[:half]]) / scale
    found = closest(moments * scale, target, np.maximum(wanted, 0.0))
    if found is None:
        raise _not_on(family)
    found = found * scale
    return np.tile(found[:half], 2), np.tile(found[half:], 2)


def _positive_system(family: Family, material: Material | GradientTensor) -> tuple[Array, Array]:
    """Moment rows over half the family (opposite bonds are equal) and their targets."""
    half = family.size // 2
    return _rows(material, family.angle[:half], 2 * bond_weights(family, material)[:half])


@singledispatch
def _rows(material: Material | GradientTensor, psi: Array, weight: Array) -> tuple[Array, Array]:
    """Moment rows of bonds at angles ψ with some weights, and the material's moments."""
    raise TypeError(f"no moments are known of a {type(material).__name__}")


@_rows.register
def _(material: ElasticTensor, psi: Array, weight: Array) -> tuple[Array, Array]:
    moments_n, moments_t = elastic_moments(psi)
    # Rotation and homogeneous strain stay apart.
    decoupled = weight * stretch_rows(psi)[1][1:]
    rows = np.hstack([weight * moments_n, weight * moments_t])
    rows = np.vstack([rows, np.hstack([np.zeros_like(decoupled), decoupled])])
    return rows, np.concatenate([material.voigt[PAIRS3], [0.0, 0.0]])


@_rows.register
def _(material: GradientTensor, psi: Array, weight: Array) -> tuple[Array, Array]:
    return weight * conductive_moments(psi), material.matrix[PAIRS2]


def representable(family: Family, material: Material) -> bool:
    """Whether non-negative moduli with the exact moments exist on this family."""
    moments, target = _positive_system(family, material)
    norms = np.linalg.norm(moments, axis=1)
    norms[norms == 0] = 1.0
    return feasible(moments / norms[:, None] * norms.max(), target / norms * norms.max())


def representable_by_directions(material: Material, count: int = 360) -> bool:
    """Whether non-negative moduli exist for bonds in `count` directions, as no lattice has.

    If not, no family of any m has them, for the tensors that can be made grow with the
    directions; half a degree between these decides but the last 1e-4 of that growth.
    """
    psi = np.pi * np.arange(count) / count
    return feasible(*_rows(material, psi, np.ones(count)))


def _conductive(
    family: Family,
    material: GradientTensor,
    calibration: Calibration,
    law: AngularLaw,
) -> Array:
    """k of every bond, shape (n,), or k_b."""
    target = material.matrix[PAIRS2]
    psi = family.angle
    weight = bond_weights(family, material)
    name = type(law).__name__
    if calibration == "lattice":
        basis = law.conductive(psi, material, extended=True)
        system = (weight * conductive_moments(psi)) @ basis.T
    else:
        basis = law.conductive(psi, material, extended=False)
        circle = _circle(law)
        power = 2 if material.physics.energy_by_length else 1
        radial = 0.5 * family.horizon ** (power + 1) * family.influence.moment(power)
        radial *= 2 * np.pi / len(circle)
        on_circle = law.conductive(circle, material, extended=False)
        system = radial * conductive_moments(circle) @ on_circle.T
    conductivity = _solve(system, target, f"{name} law ({calibration})") @ basis
    if calibration == "positive":
        half = family.size // 2
        scale = np.maximum(np.abs(conductivity[:half]), 1e-3 * np.abs(conductivity).max())
        moments, target = _positive_system(family, material)
        found = closest(moments * scale, target, np.maximum(conductivity[:half] / scale, 0.0))
        if found is None:
            raise _not_on(family)
        conductivity = np.tile(found * scale, 2)
    return _mirrored(conductivity)


def quartic_moments(psi: Array) -> Array:
    """Products n n n n with 0 to 4 factors n2, shape (5, n)."""
    c, s = np.cos(psi), np.sin(psi)
    return np.array([c ** (4 - k) * s**k for k in range(5)])


def quartic_target(family: Family, material: ConductivityTensor, law: AngularLaw | None) -> Array:
    """½ ∫ Λ k n n n n dA over the disc of the continuum's law, as `quartic_moments`, shape (5,).

    It does not depend on the disc: k is what makes ½ ∫ Λ k n n dA the conductivity.
    """
    law = Cosine() if law is None else law
    circle = _circle(law)
    basis = law.conductive(circle, material, extended=False)
    weight = 0.5 * family.horizon**2 * family.influence.moment(1) * 2 * np.pi / len(circle)
    system = weight * conductive_moments(circle) @ basis.T
    what = f"{type(law).__name__} law (continuum)"
    on_circle = _solve(system, material.matrix[PAIRS2], what) @ basis
    return np.asarray(weight * quartic_moments(circle) @ on_circle)


def _not_on(family: Family) -> NotRepresentableError:
    return NotRepresentableError(
        f"no non-negative bond moduli represent this tensor at m = {family.m:g}"
    )


def _mirrored(values: Array) -> Array:
    """Make opposite bonds equal to the last bit (their angles differ by π only in exact maths)."""
    half = len(values) // 2
    return np.tile(0.5 * (values[:half] + values[half:]), 2)
