"""Natural modes: frequencies and shapes in which a body vibrates about its equilibrium (Eq. 91).

K x = ω² M x with the masses of particles; rotations carry none and follow the displacements.
Bodies may be free, wholly or in part: their rigid motions are counted, and left out. Loads and
prescribed values play no part, for linear vibrations are the same about every equilibrium.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import LinearOperator

from .. import threads
from ..arrays import Array, Mask
from ..blas import one_thread
from ..bonds import Cells
from ..errors import ConvergenceError, MechanismError, NegativeCurvatureError, SceneError
from ..linear import TwoLevel, eigen, method
from ..linear.condensed import Condensed
from ..linear.two_level import LARGEST_COARSE
from ..material.physics import ELASTICITY
from ..operators.assembled import to_csr
from ..operators.mass import inertia
from ..problem import Description, Discretisation
from ..problem.rigid import rigid_motions
from ..result import Result
from .recording import Progress
from .registry import Analysis

# Displacements up to which a dense solver is as quick and leaves no doubt.
_DENSE = 1_200
# The same where every product needs an inner solve.
_DENSE_CONDENSED = 2_400
# And up to which it is bearable where a large share of all modes is wanted.
_DENSE_MOST = 6_000
# Modes that the iteration is fit for.
_MOST = 300
# Unknowns up to which pairs are counted by a factorisation; larger bodies are searched again.
_COUNTED = 5_000
# Of the preconditioner: distance of coarse nodes (cells) and products of smoothing. So many vectors
# share its set-up that closer nodes and less smoothing than in statics take a quarter less.
_COARSENING, _DEGREE = 4, 1
# Searches after a pair was missed.
_REPEATS = 3


@dataclass(frozen=True, eq=False)
class Modes(Result):
    """Natural modes of a body.

    Attributes
    ----------
    discretisation : Discretisation
    frequencies : ndarray, shape (count,)
        Circular, rad/s, ascending, of elastic modes only.
    rigid : int
        Number of motions of the body, or of its parts, that strain nothing.
    unknowns : ndarray, shape (count, components, N)
        u1, u2 and θ Δx of every mode, of one joule's kinetic measure: Σ mass |u|² = 1 (kg m² per
        unit thickness). Zero where held, NaN where set aside.
    residuals : ndarray, shape (count,)
        |K x − ω² M x| / (ω² |M x|).
    mass : ndarray, shape (N,)
        Of the particles, kg per unit thickness.
    statistics : mapping
        How they were obtained.
    """

    discretisation: Discretisation
    frequencies: Array
    rigid: int
    unknowns: Array
    residuals: Array
    mass: Array
    statistics: Mapping[str, float | int | str]

    @property
    def scene(self) -> Description:
        """The scene that vibrates."""
        return self.discretisation.scene

    @property
    def points(self) -> Array:
        """Particle centres, shape (N, 2), m."""
        return self.discretisation.lattice.places

    @property
    def shapes(self) -> Array:
        """Displacements of the modes, shape (count, N, 2), m for Σ mass |u|² = 1."""
        return np.moveaxis(self.unknowns[:, :2], 1, 2)

    @property
    def rotations(self) -> Array:
        """Rotations of the modes, shape (count, N), rad; NaN where the solid has none."""
        if self.unknowns.shape[1] < 3:
            return np.full(self.unknowns.shape[::2], np.nan)
        return self.unknowns[:, 2] / self.scene.spacing

    @property
    def warnings(self) -> tuple[str, ...]:
        """What the answer leaves out or settles by a rule, one sentence each."""
        return self.discretisation.warnings

    @property
    def cells(self) -> Cells:
        """The particles' cells, parted where bonds carry nothing."""
        return Cells.of(self.discretisation.bonds)

    def fields(self) -> dict[str, Array]:
        """Every mode's displacement (N, 2) and rotation (N,), by name."""
        named: dict[str, Array] = {}
        for k, (shape, rotation) in enumerate(zip(self.shapes, self.rotations, strict=True), 1):
            named[f"mode {k} displacement"] = shape
            if self.unknowns.shape[1] == 3:
                named[f"mode {k} rotation"] = rotation
        return named

    def summary(self) -> dict[str, Any]:
        """Plain values, for JSON."""
        return {
            "frequencies": self.frequencies.tolist(),
            "rigid": self.rigid,
            "residuals": self.residuals.tolist(),
            "mass": float(self.mass.sum()),
            **self.statistics,
            "warnings": self.warnings,
        }


def solve(
    scene: Description, count: int, tolerance: float = 1e-8, progress: Progress | None = None
) -> Modes:
    """The lowest elastic modes.

    Parameters
    ----------
    scene : Scene
        Elastic, with a density.
    count : int
        Of the elastic modes wanted; rigid motions do not count.
    tolerance : float
        Of every pair's residual; frequencies err by its square. On large bodies rounding may
        leave more.
    progress : callable, optional
        Told the share that is done, as far as convergence lets it be known.

    Returns
    -------
    Modes

    Raises
    ------
    SceneError
        Without density, for a conductive body, or for more modes than the body has.
    NegativeCurvatureError
        If the body is not stable.
    MechanismError
        If it can move without strain otherwise than rigidly.
    ConvergenceError

    Examples
    --------
    Lamé's mode of a free square, ω = π/L √((C11 − C12)/ρ):

    >>> from solver import ElasticTensor, Scene, modes, rectangle
    >>> scene = Scene(
    ...     region=rectangle(1.0, 1.0), spacing=0.05, m=3, surface="extrapolated", density=1.0,
    ...     material=ElasticTensor.orthotropic(E1=1.0, E2=1.0, G12=0.4, nu12=0.2),
    ... )
    >>> found = modes.solve(scene, 6)
    >>> found.rigid, bool(abs(found.frequencies - 3.141593 / 1.2**0.5).min() < 0.02)
    (3, True)
    """
    begun = perf_counter()
    density = _checked(scene, count, tolerance)
    discretisation = Discretisation.of(scene, free=True)
    operator, kind = discretisation.operator, discretisation.stability.kind
    shares, physics = discretisation.storage("density"), scene.physics
    mass = inertia(shares, operator.active, physics, operator.components)
    if operator.identity_rows is not None:
        mass[operator.identity_rows] = 0.0
    rigid = rigid_motions(discretisation.bonds, discretisation.prescribed, physics)
    rigid = rigid[:, :, operator.active]
    most = int((mass > 0).sum()) - len(rigid)
    if count > most:
        raise SceneError(f"{count} modes are asked for, but this body has {max(most, 0)}")
    little = _DENSE_CONDENSED if kind == "indefinite" else _DENSE
    small = most <= little or 5 * (count + eigen.guards(count)) > most
    if most > _DENSE_MOST and (small or count > _MOST):
        raise SceneError(
            f"{count} of {most} modes are too many at once: more than {_MOST}, or than a sixth of "
            f"them, are found on bodies of up to {_DENSE_MOST} only"
        )
    small |= count > _MOST
    with one_thread(), threads.suited(discretisation.operator):
        search = _Search(discretisation, mass, rigid, count, tolerance)
        pairs, checked, prepared = (
            search.directly() if small else search.iteratively(begun, progress)
        )
    if progress is not None:
        progress(1.0)
    vectors = pairs.vectors.T.reshape(count, operator.components, -1)
    unknowns = np.zeros((count, operator.components, discretisation.lattice.count))
    unknowns[:, :, operator.active] = vectors
    aside = np.isnan(discretisation.values).any(axis=0)
    unknowns[:, :, aside] = np.nan
    # From masses in cells and stiffness per volume to kilograms.
    unknowns /= np.sqrt(density) * scene.spacing
    largest = np.argmax(np.abs(np.nan_to_num(unknowns[:, :2])).reshape(count, -1), axis=1)
    sign = np.sign(np.take_along_axis(unknowns[:, :2].reshape(count, -1), largest[:, None], axis=1))
    unknowns *= sign[:, :, None]
    done = perf_counter()
    return Modes(
        discretisation,
        np.sqrt(pairs.values / density),
        len(rigid),
        unknowns,
        pairs.residuals,
        np.where(aside, np.nan, density * scene.spacing**2 * shares),
        {
            "particles": discretisation.lattice.count,
            "unknowns": operator.shape[0],
            "bonds": operator.directed_bonds,
            "kind": kind,
            "method": search.name,
            "iterations": pairs.iterations,
            "complete by": checked,
            "setup_seconds": prepared if not small else discretisation.seconds,
            "solve_seconds": done - begun - (prepared if not small else discretisation.seconds),
        },
    )


def _checked(scene: Description, count: int, tolerance: float) -> float:
    """What can be said before anything is built; returns the density."""
    if isinstance(count, bool) or not isinstance(count, (int, np.integer)) or count < 1:
        raise SceneError(f"the number of modes must be a positive integer, not {count!r}")
    if not 0 < tolerance < 1:
        raise SceneError(f"the tolerance must lie between 0 and 1, not {tolerance}")
    if scene.physics is not ELASTICITY:
        raise SceneError("modes are of elastic bodies: heat does not vibrate")
    return scene.density_for("modes")


class _Search:
    """One body's pencil and the ways to its pairs."""

    def __init__(
        self,
        discretisation: Discretisation,
        mass: Array,
        rigid: Array,
        count: int,
        tolerance: float,
    ) -> None:
        self.discretisation, self.count, self.tolerance = discretisation, count, tolerance
        self.operator = discretisation.operator
        self.mass, self.rigid = mass, rigid
        self.indefinite = discretisation.stability.kind == "indefinite"
        self.name = "dense"

    def directly(self) -> tuple[eigen.Eigenpairs, str, float]:
        """All eigenvalues of a small body: pairs, how it is known that none is missing, seconds."""
        matrix, mass = self._free(to_csr(self.operator))
        scale, rigid = self.operator.identity_scale, len(self.rigid)
        values, own = eigen.dense(matrix, mass, rigid + self.count)
        vectors = np.zeros((self.mass.size, len(values)))
        vectors[self._moving] = own
        if values[0] < -1e-9 * scale:
            raise self._unstable(vectors[:, 0])
        elastic = values[rigid:]
        if elastic[0] <= eigen.ZERO * scale:
            raise self._mechanism(vectors[:, rigid])
        chosen = slice(rigid, rigid + self.count)
        found = eigen.Eigenpairs(values[chosen], vectors[:, chosen], np.zeros(self.count), 0)
        residuals = np.empty(self.count)
        for k, value in enumerate(found.values):
            inert = value * self.mass.ravel() * found.vectors[:, k]
            left = self.operator.product(
                found.vectors[:, k].reshape(self.operator.components, -1), masked=True
            )
            residuals[k] = np.linalg.norm(left.ravel() - inert) / np.linalg.norm(inert)
        return (
            eigen.Eigenpairs(found.values, found.vectors, residuals, 0),
            "dense solve",
            0.0,
        )

    def iteratively(
        self, begun: float, progress: Progress | None = None
    ) -> tuple[eigen.Eigenpairs, str, float]:
        """LOBPCG, checked: pairs, how it is known that none is missing, seconds of preparation."""
        pencil = self._pencil()
        prepared = perf_counter() - begun
        try:
            if self.indefinite or self.operator.ended_stiffness is not None:
                eigen.definite(pencil)
        except NegativeCurvatureError as error:
            raise self._located(pencil) from error
        found = eigen.lowest(pencil, self.count, self.tolerance, progress=progress)
        checked = ""
        for _ in range(_REPEATS):
            self._judge(pencil, found)
            counted = self.operator.shape[0] <= _COUNTED
            if counted:
                more, checked = self._uncounted(pencil, found), "inertia of a factorisation"
            else:
                more, steps = eigen.missing(pencil, found, self.count)
                checked = f"search from another start, {steps} iterations"
            if not more.shape[1]:
                break
            guess = np.column_stack([found.vectors[:, : self.count], more])
            again = eigen.lowest(pencil, self.count, self.tolerance, guess)
            found = eigen.Eigenpairs(
                again.values, again.vectors, again.residuals, again.iterations + found.iterations
            )
        else:
            raise ConvergenceError("modes are missing however often they are searched for")
        found = found.first(self.count)
        if self.indefinite:
            found = eigen.Eigenpairs(
                found.values, self._expand(found), found.residuals, found.iterations
            )
        return found, checked, prepared

    def _pencil(self) -> eigen.Pencil:
        operator, kind = self.operator, self.discretisation.stability.kind
        most = int(np.ceil(np.sqrt(operator.shape[0] / LARGEST_COARSE)))
        inverse: LinearOperator = TwoLevel(
            method.positive(operator, kind), max(_COARSENING, most), _DEGREE
        )
        fixed, mass, rigid = operator.identity_rows, self.mass, self.rigid
        self.name = "LOBPCG, two-level"
        if not self.indefinite:
            stiffness = operator
        else:
            self.name = "LOBPCG on condensed displacements, two-level"
            self.condensed = stiffness = Condensed(operator)
            inverse = self.condensed.preconditioner(inverse)
            mass, rigid = mass[:2], rigid[:, :2]
            fixed = None if fixed is None else fixed[:2]
        return eigen.Pencil(
            stiffness,
            mass.ravel(),
            inverse,
            np.ascontiguousarray(rigid.reshape(len(rigid), mass.size).T),
            operator.identity_scale,
            None if fixed is None else fixed.ravel(),
        )

    @property
    def _moving(self) -> Mask:
        """Unknowns that are not held, as a mask over the flattened ones."""
        fixed = self.operator.identity_rows
        return np.ones(self.mass.size, dtype=bool) if fixed is None else ~fixed.ravel()

    def _free(self, matrix: sparse.csr_array) -> tuple[sparse.csr_array, Array]:
        """Matrix and masses without held unknowns."""
        moving = self._moving
        return sparse.csr_array(matrix[moving][:, moving]), self.mass.ravel()[moving]

    def _uncounted(self, pencil: eigen.Pencil, found: eigen.Eigenpairs) -> Array:
        """Vectors of a further search if the inertia tells of more pairs than were found."""
        values = found.values[self.count - 1 :]
        # In the widest gap above the last wanted one, so that rounding decides nothing.
        gap = int(np.argmax(np.diff(values))) if len(values) > 1 else 0
        value = 0.5 * (values[gap] + values[gap + 1])
        counted = eigen.below(*self._free(to_csr(self.operator)), value)
        if counted <= len(self.rigid) + self.count + gap:
            return pencil.rigid[:, :0]
        more, _ = eigen.missing(pencil, found, self.count)
        return more if more.shape[1] else pencil.start(3, seed=7)

    def _judge(self, pencil: eigen.Pencil, found: eigen.Eigenpairs) -> None:
        """Refuse what is not a vibration."""
        lowest = found.values[0]
        if lowest < -eigen.ZERO * pencil.scale:
            raise self._unstable(found.vectors[:, 0])
        if lowest <= eigen.ZERO * pencil.scale:
            raise self._mechanism(found.vectors[:, 0])

    def _located(self, pencil: eigen.Pencil) -> NegativeCurvatureError:
        """The error for an unstable body, with the place of its lowest mode."""
        try:
            found = eigen.lowest(pencil, 4, 1e-2)
        except ConvergenceError:
            return self._unstable(None)
        return self._unstable(found.vectors[:, 0] if found.values[0] < 0 else None)

    def _place(self, vector: Array) -> str:
        components = 2 if self.indefinite and len(vector) < self.mass.size else None
        field = vector.reshape(components or self.operator.components, -1)[:2]
        size = np.hypot(*field)
        points = self.discretisation.lattice.places[self.operator.active]
        x, y = points[int(np.argmax(size))]
        return f"it moves most at ({x:.4g}, {y:.4g})"

    def _unstable(self, vector: Array | None) -> NegativeCurvatureError:
        where = "" if vector is None else f", {self._place(vector)}"
        cure = "calibration='positive' (for C66 ≥ C12) or another m"
        if self.operator.ended_stiffness is not None:
            cure = "surface='volume' (free corners of nearly incompressible solids), " + cure
        return NegativeCurvatureError(
            f"the body is unstable: a motion has negative energy{where}, and no frequency. Use "
            f"{cure}"
        )

    def _mechanism(self, vector: Array) -> MechanismError:
        return MechanismError(
            f"beside its {len(self.rigid)} rigid motions the body has one that strains no bond (a "
            f"hinge, or a part on a single bond): {self._place(vector)}"
        )

    def _expand(self, found: eigen.Eigenpairs) -> Array:
        """Displacements with the rotations that follow them, (3 n, k)."""
        silent = np.zeros(self.operator.shape[0])
        return np.column_stack([self.condensed.expand(x, silent) for x in found.vectors.T])


ANALYSIS = Analysis("modes", "Natural modes about equilibrium.", solve)
