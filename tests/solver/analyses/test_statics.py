"""Static and steady solutions: patch tests for every sign of the operator, units, refusals."""

import numba
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.sparse.linalg import spsolve

from references.analytic.elasticity import PolynomialDisplacement, combine, equilibrium_polynomials
from solver import (
    ConductivityTensor,
    ConvergenceError,
    Cosine,
    Crack,
    ElasticTensor,
    Family,
    InadmissibleMaterialError,
    Inclusion,
    Load,
    NegativeCurvatureError,
    Scene,
    Support,
    TwoHarmonic,
    disc,
    rectangle,
    threads,
)
from solver.material import assess, calibrate
from solver.operators import BondOperator
from solver.operators.assembled import to_csr
from tests.solver.bodies import DISC, FIG_7, block, conductivities, few, voigts

# Name → (tensor, sign of its operator).
SOLIDS = {
    "anisotropic": (FIG_7, "positive"),
    "nu 1/5": (ElasticTensor.isotropic(1.0, 0.2).voigt, "positive"),
    "nu 1/3": (ElasticTensor.isotropic(1.0, 1 / 3).voigt, "central"),
    "Cauchy": (np.array([[3, 0.8, 0.2], [0.8, 2, -0.1], [0.2, -0.1, 0.8]]), "central"),
    "nu 0.45": (ElasticTensor.isotropic(1.0, 0.45).voigt, "indefinite"),
    "plane strain 0.36": (ElasticTensor.isotropic(1.0, 0.36, "strain").voigt, "indefinite"),
}


def patch_scene(field, region=None, spacing=0.1, m=3, loads=(), **options):
    """A body whose layer is given a field's displacement and rotation."""
    layer = Support.layer(m + 0.5, displacement=field.displacement, rotation=field.rotation)
    region = disc(1.0) if region is None else region
    material = ElasticTensor(field.voigt)
    return Scene(region, spacing, material, [layer], loads, m=m, **options)


def patch_error(field, scene, tolerance=1e-13):
    """Relative error of displacements and rotations at the free particles."""
    found = scene.solve(tolerance=tolerance)
    free = ~found.prescribed
    assert free.sum() > 20
    x, y = found.points[free].T
    u = field.displacement(x, y)
    errors = [np.linalg.norm(found.displacement[free] - u) / np.linalg.norm(u)]
    if found.statistics.kind != "central":
        # Rotations matter as they move the horizon.
        wrong = np.linalg.norm(found.rotation[free] - field.rotation(x, y))
        errors.append(wrong * scene.m * scene.spacing / np.linalg.norm(u))
    return max(errors)


def field_of(voigt, seed=0, degrees=(1, 2)):
    """A random combination of all equilibrium fields of the degrees given."""
    rng = np.random.default_rng(seed)
    fields = [f for degree in degrees for f in equilibrium_polynomials(voigt, degree)]
    return combine(fields, rng.uniform(-1, 1, len(fields)))


# ---- patch tests --------------------------------------------------------------------------------


@pytest.mark.parametrize("m", [2, 3, 4.5])
@pytest.mark.parametrize("name", SOLIDS)
def test_quadratic_equilibrium_fields_are_exact(name, m):
    voigt, sign = SOLIDS[name]
    field = field_of(voigt)
    scene = patch_scene(field, m=m)
    assert scene.discretise().stability.kind == sign
    assert patch_error(field, scene) < 1e-11


@pytest.mark.parametrize("surface", ["none", "volume"])
@pytest.mark.parametrize("rule", ["full", "partial", "exact"])
@pytest.mark.parametrize("influence", ["constant", "conical"])
def test_patch_with_every_family(rule, influence, surface):
    field = field_of(FIG_7, 1)
    scene = patch_scene(field, area_rule=rule, influence=influence, surface=surface)
    assert patch_error(field, scene) < 1e-11


@pytest.mark.parametrize("name", ["anisotropic", "nu 1/5"])
def test_patch_with_the_positive_calibration(name):
    field = field_of(SOLIDS[name][0], 2)
    assert patch_error(field, patch_scene(field, calibration="positive")) < 1e-11


@few
@given(voigts(floor=0.2), st.integers(0, 1000))
def test_patch_for_any_admissible_tensor(voigt, seed):
    assume(assess(Family(3), calibrate(Family(3), ElasticTensor(voigt))).margin > 0.05)
    field = field_of(voigt, seed)
    assert patch_error(field, patch_scene(field)) < 1e-11


def test_patch_on_a_plate_with_a_hole():
    field = field_of(FIG_7, 3)
    scene = patch_scene(field, rectangle(3.0, 2.0, angle=0.3) - disc(0.2), m=2)
    assert patch_error(field, scene) < 1e-11


@pytest.mark.parametrize("name", ["anisotropic", "nu 1/3", "nu 0.45"])
def test_quadratic_fields_with_their_body_force_are_exact(name):
    rng = np.random.default_rng(4)
    coefficients = np.zeros((2, 3, 3))
    for i, j in ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)):
        coefficients[:, i, j] = rng.uniform(-1, 1, 2)
    field = PolynomialDisplacement(SOLIDS[name][0], coefficients)
    scene = patch_scene(field, loads=[Load.body_force(field.body_force)])
    assert patch_error(field, scene) < 1e-11
    # Without the force it is another field.
    assert patch_error(field, patch_scene(field)) > 1e-3


@pytest.mark.parametrize("name", ["anisotropic", "nu 0.45"])
def test_a_uniform_couple_turns_particles_against_the_continuum(name):
    # With γ = −θ in every bond the moment is Σ (w/2)|ξ| k_t θ = 4 (C66 − C12) θ.
    voigt, theta = SOLIDS[name][0], 0.3
    couple = 4 * (voigt[2, 2] - voigt[0, 1]) * theta
    scene = Scene(
        disc(1.0),
        0.1,
        ElasticTensor(voigt),
        [Support.layer(3.5, displacement=0.0, rotation=theta)],
        [Load.couple(couple)],
        m=3,
    )
    found = scene.solve(tolerance=1e-13)
    np.testing.assert_allclose(found.rotation, theta, rtol=1e-10)
    assert np.abs(found.displacement).max() < 1e-11


def test_a_patch_wrong_by_one_per_cent_is_seen():
    field = field_of(FIG_7)
    off = FIG_7.copy()
    off[0, 0] *= 1.01
    scene = patch_scene(field)
    wrong = Scene(scene.region, 0.1, ElasticTensor(off), scene.supports, m=3)
    assert patch_error(field, wrong) > 1e-5
    # The continuum calibration is wrong by a few per cent at any spacing.
    assert patch_error(field, patch_scene(field, calibration="continuum")) > 1e-5


def test_free_rotations_in_the_layer_spoil_the_patch():
    # prescribe the rotation wherever it is known.
    field = field_of(FIG_7)
    layer = Support.layer(3.5, displacement=field.displacement)
    scene = Scene(disc(1.0), 0.1, ElasticTensor(FIG_7), [layer], m=3)
    found = scene.solve()
    inner = np.hypot(*found.points.T) < 0.6
    u = field.displacement(*found.points[inner].T)
    assert 1e-4 < np.linalg.norm(found.displacement[inner] - u) / np.linalg.norm(u) < 0.1


# ---- conduction ---------------------------------------------------------------------------------


def heat_error(temperature, matrix, loads=(), **options):
    scene = Scene(
        disc(1.0),
        0.1,
        ConductivityTensor(matrix),
        [Support.layer(3.5, temperature=temperature)],
        loads,
        m=3,
        **options,
    )
    found = scene.solve(tolerance=1e-13)
    free = ~found.prescribed
    wanted = temperature(*found.points[free].T)
    return np.linalg.norm(found.temperature[free] - wanted) / np.linalg.norm(wanted)


def cubic(x, y):
    # Eq. 169 with the x₂³/3 that conducts without a source.
    return x**3 / 5 - x**2 * y + x * y**2 + y**3 / 3


@pytest.mark.parametrize("calibration", ["lattice", "positive"])
@pytest.mark.parametrize("law", [None, TwoHarmonic(), Cosine(12)])
def test_cubic_temperatures_are_exact(calibration, law):
    assert heat_error(cubic, DISC, calibration=calibration, law=law) < 1e-11


def test_the_printed_cubic_needs_its_source():
    def printed(x, y):
        return cubic(x, y) - (1 / 3 - 1 / 5) * y**3

    # div(D ∇T) = −0.8 x₂ for the printed field: a source of 0.8 x₂ balances it.
    source = [Load.source(lambda x, y: 0.8 * y)]
    assert heat_error(printed, DISC, source) < 1e-11
    assert heat_error(printed, DISC) > 1e-3
    assert heat_error(printed, DISC, [Load.source(lambda x, y: 0.8 * 1.01 * y)]) > 1e-5


@few
@given(conductivities(), st.tuples(*[st.floats(-1, 1)] * 6))
def test_any_quadratic_temperature_with_its_source(matrix, c):
    assume(max(abs(v) for v in c) > 0.1)

    def temperature(x, y):
        return c[0] + c[1] * x + c[2] * y + c[3] * x * x + c[4] * x * y + c[5] * y * y

    sink = 2 * c[3] * matrix[0, 0] + 2 * c[4] * matrix[0, 1] + 2 * c[5] * matrix[1, 1]
    assert heat_error(temperature, matrix, [Load.source(-sink)]) < 1e-10


# ---- methods ------------------------------------------------------------------------------------


def test_indefinite_bodies_small_and_large():
    # Small ones without, large ones with two levels: the answer is the field both times.
    field = field_of(SOLIDS["nu 0.45"][0], 5)
    methods = []
    for cells in (10, 26):
        scene = patch_scene(field, spacing=1 / cells, m=2)
        assert patch_error(field, scene, tolerance=1e-12) < 1e-10
        methods.append(scene.solve().statistics.method)
    assert methods[0] == "CG on condensed displacements, block Jacobi"
    assert methods[1] == "CG on condensed displacements, two-level"


@pytest.mark.parametrize("name", ["anisotropic", "nu 1/3"])
def test_preconditioners_give_the_same_answer(name):
    field = field_of(SOLIDS[name][0], 6)
    scene = patch_scene(field, spacing=1 / 20, m=2, cracks=[Crack((-2.0, 0.0), (0.0, 0.0))])
    found = [
        scene.solve(tolerance=1e-12, preconditioning=choice)
        for choice in ("block-jacobi", "two-level")
    ]
    size = np.abs(found[0].displacement).max()
    np.testing.assert_allclose(found[0].displacement, found[1].displacement, atol=1e-9 * size)
    assert found[0].statistics.method != found[1].statistics.method
    with pytest.raises(ValueError, match="unknown preconditioner"):
        scene.solve(preconditioning="magic")


@pytest.mark.parametrize("name", ["anisotropic", "nu 1/3", "nu 0.45"])
def test_the_solution_solves_the_sparse_matrix_too(name):
    scene = Scene(
        rectangle(2.0, 1.0),
        0.1,
        ElasticTensor(SOLIDS[name][0]),
        [Support.where(lambda x, y: x < -0.8, displacement=0.0), Support.layer(0.5, u2=0.1)],
        [Load.body_force((1.0, -0.3))],
        m=2,
        cracks=[Crack((0.0, -1.0), (0.0, 0.1))],
    )
    found = scene.solve(tolerance=1e-12)
    parts = found.discretisation
    operator = parts.operator
    matrix = to_csr(operator).toarray()
    x = np.linalg.solve(matrix, parts.right_hand_side())
    wanted = parts.field(x)
    np.testing.assert_allclose(found.unknowns, wanted, atol=1e-9 * np.abs(wanted).max())
    np.testing.assert_array_equal(found.unknowns[parts.prescribed], parts.values[parts.prescribed])


@pytest.mark.skipif(numba.config.NUMBA_NUM_THREADS < 2, reason="one thread only")
@pytest.mark.parametrize("name", ["anisotropic", "nu 1/3", "nu 0.45"])
def test_solutions_are_the_same_to_the_last_bit_for_any_number_of_threads(name, monkeypatch):
    # Or so small a body would keep to one thread both times.
    monkeypatch.setattr(threads, "_WORK", 1)
    field = field_of(SOLIDS[name][0], 7)
    scene = patch_scene(field, spacing=1 / 30, m=2, cracks=[Crack((-2.0, 0.0), (0.0, 0.0))])
    before = numba.get_num_threads()
    try:
        found = []
        for count in (1, 2):
            numba.set_num_threads(count)
            found.append(scene.solve().unknowns)
    finally:
        numba.set_num_threads(before)
    np.testing.assert_array_equal(*found)


@pytest.mark.parametrize("name", ["anisotropic", "nu 1/3", "nu 0.45"])
@pytest.mark.parametrize(
    ("length", "stiffness", "size"), [(1e-6, 1e12, 1e-12), (1e4, 1e-6, 1.0), (1e-9, 1.0, 1e6)]
)
def test_units_do_not_matter(name, length, stiffness, size):
    field = field_of(SOLIDS[name][0], 8)

    def displacement(x, y):
        return size * field.displacement(x / length, y / length)

    def rotation(x, y):
        return size / length * field.rotation(x / length, y / length)

    def solve(region, spacing, scale, **values):
        layer = Support.layer(2.5, **values)
        crack = Crack((-2 * spacing / 0.1, 0.0), (0.0, 0.0))
        material = ElasticTensor(scale * field.voigt)
        return Scene(region, spacing, material, [layer], m=2, cracks=[crack]).solve(1e-12)

    plain = solve(disc(1.0), 0.1, 1.0, displacement=field.displacement, rotation=field.rotation)
    other = solve(
        disc(length), 0.1 * length, stiffness, displacement=displacement, rotation=rotation
    )
    wanted = plain.displacement
    np.testing.assert_allclose(other.displacement / size, wanted, atol=1e-10 * np.abs(wanted).max())


# ---- equilibrium --------------------------------------------------------------------------------


@pytest.mark.parametrize("surface", ["none", "volume"])
def test_reactions_balance_the_loads(surface):
    scene = Scene(
        rectangle(2.0, 1.0),
        0.1,
        ElasticTensor(FIG_7),
        [Support.where(lambda x, y: x < -0.8, displacement=0.0, rotation=0.0)],
        [Load.traction((1.0, 0.5), (1.0, -0.5), (1.0, 0.5)), Load.couple(0.2, lambda x, y: x > 0)],
        m=3,
        surface=surface,
    )
    found = scene.solve(tolerance=1e-12)
    parts = found.discretisation
    # The whole body as unknowns: what its rows lack is carried by the support.
    whole = BondOperator(parts.bonds, parts.moduli, np.zeros_like(parts.prescribed))
    rows = whole.matvec(found.unknowns.ravel()).reshape(3, -1) * scene.spacing**2
    load = parts.load * scene.spacing**2
    reaction = np.where(parts.prescribed, rows - load, 0.0)
    np.testing.assert_allclose(reaction[:2].sum(axis=1), [-1.0, -0.5], rtol=1e-9)
    x, y = found.points.T
    moment = (x * rows[1] - y * rows[0] + scene.spacing * rows[2])[found.prescribed].sum()
    applied = (x * load[1] - y * load[0] + scene.spacing * load[2]).sum()
    assert applied == pytest.approx(0.95 * 0.5 + 0.2 * 1.0, rel=1e-12)
    assert moment == pytest.approx(-applied, rel=1e-8)


def test_heat_that_enters_leaves():
    scene = Scene(
        disc(1.0),
        0.1,
        ConductivityTensor(DISC),
        [Support.layer(1.5, temperature=0.0)],
        [Load.source(2.0, where=disc(0.4))],
        m=3,
    )
    found = scene.solve(tolerance=1e-12)
    parts = found.discretisation
    whole = BondOperator(parts.bonds, parts.moduli, np.zeros_like(parts.prescribed))
    rows = whole.matvec(found.temperature)
    assert rows[found.prescribed].sum() == pytest.approx(-parts.load.sum(), rel=1e-10)
    assert found.temperature.min() >= 0
    assert found.temperature.max() > 0


# ---- corner cases and refusals ------------------------------------------------------------------


def test_no_load_no_displacement():
    found = Scene(
        disc(1.0), 0.1, ElasticTensor(FIG_7), [Support.layer(3, displacement=0.0, rotation=0.0)]
    ).solve()
    assert not found.unknowns.any()
    assert found.statistics.residual == 0.0
    assert found.statistics.iterations == 0


@pytest.mark.parametrize("name", ["anisotropic", "nu 1/3", "nu 0.45"])
def test_a_body_without_unknowns(name):
    field = field_of(SOLIDS[name][0], 9)
    found = patch_scene(field, block(4, 4), spacing=1.0, m=3).solve()
    assert found.prescribed.all()
    np.testing.assert_allclose(found.displacement, field.displacement(*found.points.T))
    assert found.statistics.unknowns == 0


@pytest.mark.parametrize("tolerance", [0.0, 1.0, -1e-3, np.nan])
def test_bad_tolerances(tolerance):
    with pytest.raises(ValueError, match="tolerance must lie between"):
        patch_scene(field_of(FIG_7)).solve(tolerance=tolerance)


@pytest.mark.parametrize("cells", [10, 26])
def test_an_unreached_tolerance_is_an_error(cells):
    for name in ("anisotropic", "nu 0.45"):
        scene = patch_scene(field_of(SOLIDS[name][0]), spacing=1 / cells, m=2)
        if name == "nu 0.45" and cells == 10:
            continue  # factorised: no iterations to run out of
        with pytest.raises(ConvergenceError, match="relative residual"):
            scene.solve(tolerance=1e-12, max_iterations=1)


@pytest.mark.parametrize("width", [1, 2])
def test_negative_curvature_of_a_conductor_has_a_name(width):
    # The two-harmonic law is negative across the fibres; a narrow column has hardly any other
    # bonds, although the bulk is stable. At two cells every particle by itself looks sound.
    material = ConductivityTensor.orthotropic(8.0, 1.0)
    scene = Scene(
        block(width, 30),
        1.0,
        material,
        [Support.where(lambda x, y: (y < 3) | (y > 27), temperature=lambda x, y: y)],
        m=3,
        law=TwoHarmonic(),
        surface="none",
    )
    parts = scene.discretise()
    assert parts.stability.kind == "positive"
    assert np.linalg.eigvalsh(to_csr(parts.operator).toarray())[0] < 0
    assert (parts.operator.block_diagonal.min() > 0) == (width == 2)
    with pytest.raises(NegativeCurvatureError, match=r"negative|non-positive"):
        scene.solve()


def test_negative_curvature_of_a_solid_has_a_name():
    # C66 > C22 makes the axial bonds along 2 negative (Eq. 66).
    solid = ElasticTensor([[6.0, 0.3, 0], [0.3, 1.0, 0], [0, 0, 1.3]])
    scene = Scene(
        block(1, 30),
        1.0,
        solid,
        [Support.where(lambda x, y: (y < 3) | (y > 27), displacement=0.0, rotation=0.0)],
        [Load.body_force((0.0, 1.0))],
        m=3,
        surface="none",
    )
    parts = scene.discretise()
    assert parts.stability.kind == "positive"
    assert np.linalg.eigvalsh(to_csr(parts.operator).toarray())[0] < 0
    with pytest.raises(NegativeCurvatureError, match=r"negative|non-positive"):
        scene.solve()


def test_unstable_solids_are_refused_before_the_solve():
    with pytest.raises(InadmissibleMaterialError, match="wave vector"):
        patch_scene(field_of(ElasticTensor.isotropic(1.0, 0.4, "strain").voigt)).solve()


def test_statistics():
    found = patch_scene(field_of(FIG_7)).solve(tolerance=1e-9)
    s = found.statistics
    free = int((~found.prescribed).sum())
    assert (s.particles, s.unknowns) == (len(found.points), 3 * free)
    assert s.bonds == free * Family(3).size
    assert 0 < s.residual <= 1e-9
    assert s.kind == "positive"
    assert s.margin == pytest.approx(1.0, abs=0.2)
    assert s.setup_seconds > 0
    assert s.solve_seconds > 0
    assert s.as_dict()["method"] == s.method


@pytest.mark.parametrize("surface", ["none", "volume", "extrapolated"])
def test_a_slender_body_stops_at_what_rounding_allows_and_says_so(surface):
    scene = Scene(
        rectangle(100, 5),
        1.0,
        ElasticTensor.isotropic(1.0, 0.2),
        [Support.where(lambda x, y: x < -47, displacement=0.0)],
        [Load.body_force((0.0, 1e-3))],
        m=2,
        surface=surface,
    )
    solution = scene.solve()
    found = solution.statistics
    assert 1e-10 < found.residual < 1e-8
    assert any("rounding of the displacements" in said for said in found.warnings)
    # It is the solution: a direct one agrees with it as far as the condition lets it.
    parts = solution.discretisation
    direct = spsolve(to_csr(parts.operator).tocsc(), parts.right_hand_side())
    tip = parts.field(direct)[1].max()
    assert solution.displacement[:, 1].max() == pytest.approx(tip, rel=1e-5)
    # Where rounding is no excuse it is an error still.
    with pytest.raises(ConvergenceError, match="stopped at a relative residual"):
        scene.solve(max_iterations=30)


@pytest.mark.parametrize(("contrast", "answered"), [(1e8, True), (1e14, False)])
def test_solids_that_differ_by_too_much_for_rounding_are_refused(contrast, answered):
    """1e14: a residual of 0.4, which rounding explains, and temperatures wrong by 90 %."""
    inner = Inclusion(rectangle(6.0, 6.0), ConductivityTensor.isotropic(contrast))
    scene = Scene(
        rectangle(20, 14),
        1.0,
        ConductivityTensor.isotropic(1.0),
        [Support.where(lambda x, y: x < -7, temperature=0.0)],
        [Load.source(lambda x, y: 1 + 1e-2 * x * y)],
        m=3,
        inclusions=[inner],
    )
    if answered:
        assert any("solids so different" in said for said in scene.solve().statistics.warnings)
        return
    with pytest.raises(ConvergenceError, match="differ by too much for numbers of 16 digits"):
        scene.solve()
