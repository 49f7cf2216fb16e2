"""What is said of a solid, beside closed forms written down here."""

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from cmverify.cases.common import materials
from cmverify.cases.common.bond_energies import non_negative_moduli_exist
from cmverify.cli import app
from cmverify.studies.anisotropy.command import tensor
from cmverify.studies.anisotropy.profile import DIRECTIONS, HORIZONS, advice, profile, ripple
from cmverify.studies.stability.assessments import compare
from solver import Family

cli = CliRunner()
EXAMPLES = Path(__file__).parents[3] / "examples"
E1, E2, NU12, G12 = 140.0, 10.0, 0.3, 5.0


@pytest.fixture(scope="module")
def glass():
    return profile("isotropic", materials.isotropic(0.2), 3, 2.0)


@pytest.fixture(scope="module")
def ply():
    return profile("ply", materials.orthotropic(E1, E2, G12, NU12), 3, 1.6)


def test_an_isotropic_solid_is_what_textbooks_say(glass):
    nu, rho = 0.2, 2.0
    fast, slow = np.sqrt(1 / (1 - nu**2) / rho), np.sqrt(0.5 / (1 + nu) / rho)
    np.testing.assert_allclose(glass.speeds, [[fast, slow]] * len(DIRECTIONS), rtol=1e-12)
    np.testing.assert_allclose(glass.hole, 3.0, rtol=1e-3)  # Kirsch; read off at whole degrees
    np.testing.assert_allclose(glass.crack, 1.0, rtol=1e-12)  # K²/G = E in plane stress
    assert glass.kinks[0] == pytest.approx(0.0, abs=1e-6)
    assert glass.kinks[-1] == pytest.approx(-70.53, abs=0.01)  # Erdogan and Sih
    # Eqs. 65–70 of an isotropic solid: 12 E/(π δ³ (1 − ν²)) (1 − (1 − ν)/2) and so on.
    k = glass.micromoduli
    assert k["1111"] == pytest.approx(12 / np.pi * (1 / (1 - nu**2) - 0.5 / (1 + nu)), rel=1e-12)
    assert k["1111"] == pytest.approx(k["2222"], rel=1e-12)
    assert k["1112"] == pytest.approx(0.0, abs=1e-12)
    assert "calibration = 'lattice'" in glass.advice
    assert "no bond has a negative modulus" in glass.advice


def test_an_orthotropic_solid_is_what_lekhnitskii_says(ply):
    c11, c22 = E1 / (1 - NU12**2 * E2 / E1), E2 / (1 - NU12**2 * E2 / E1)
    along, across = ply.speeds[0], ply.speeds[36]
    np.testing.assert_allclose(along, np.sqrt([c11 / 1.6, G12 / 1.6]), rtol=1e-12)
    np.testing.assert_allclose(across, np.sqrt([c22 / 1.6, G12 / 1.6]), rtol=1e-12)
    # Hole under tension along axis 1: 1 + n, n² = 2 (√(E1/E2) − ν12) + E1/G12.
    for k, (first, second, nu) in {0: (E1, E2, NU12), 36: (E2, E1, NU12 * E2 / E1)}.items():
        n = np.sqrt(2 * (np.sqrt(first / second) - nu) + first / G12)
        assert ply.hole[k] == pytest.approx(1 + n, rel=1e-6)
        # Crack along the same axis (Sih, Paris and Irwin).
        s11, s22, s12, s66 = 1 / first, 1 / second, -nu / first, 1 / G12
        g = np.sqrt(s11 * s22 / 2) * np.sqrt(np.sqrt(s22 / s11) + (2 * s12 + s66) / (2 * s11))
        assert ply.crack[k] == pytest.approx(1 / g, rel=1e-9)


def test_energy_as_it_turns_is_exact_on_the_lattices_own_sums(glass, ply):
    for found in (glass, ply):
        assert ripple(found.energies["lattice"][1]) < 1e-12
        assert ripple(found.energies["continuum"][1]) > 1e-3
    assert ripple(ply.energies["continuum"][1]) > ripple(glass.energies["continuum"][1])


def test_admissible_horizons_are_told(glass, ply):
    """By linear programming, another way than the solver's."""
    assert glass.admissible == HORIZONS
    assert all(glass.margins["lattice", "TwoHarmonic"] > 0)
    exist = [non_negative_moduli_exist(Family(m), ply.voigt) for m in HORIZONS]
    assert ply.admissible == tuple(m for m, yes in zip(HORIZONS, exist, strict=True) if yes)
    known = [m for m, value in zip(HORIZONS, ply.margins["positive", None], strict=True)
             if value > 0]  # fmt: skip
    # At m = 2 there are such moduli, but so few directions that the lattice is no stable solid.
    assert (ply.admissible, known) == (HORIZONS, [3, 4, 5, 6, 7])


@pytest.mark.parametrize(
    ("poisson", "plane"), [(0.3, "stress"), (0.36, "stress"), (0.45, "strain")]
)
def test_what_is_advised_is_stable(poisson, plane):
    """ν < 1/3 in plane stress: no negative bonds; beyond it some. None is stable in strain."""
    voigt = materials.isotropic(poisson, plane)
    found = compare("x", voigt, 3)
    said = advice(voigt, 3, found, {})
    assert ("'total'" in said) == (plane == "stress" and poisson < 1 / 3)
    assert ("'axial'" in said) == (plane == "stress" and poisson > 1 / 3)
    if plane == "strain":
        assert not any(one.stable for one in found)
        assert "No exact calibration is stable at m = 3" in said
        assert "finite elements" in said
    else:
        chosen = [one for one in found if f"{one.calibration!r}" in said.split(":")[0]]
        assert any(one.stable for one in chosen)


@pytest.mark.parametrize(
    ("form", "text", "strain"),
    [
        ("--isotropic", "2.0,0.25", False),
        ("--isotropic", "1.875,0.2", True),
        ("--orthotropic", "2.0,2.0,0.25,0.8", False),
        ("--orthotropic", "1.875,1.875,0.2,0.78125,1.875,0.2,0.2", True),
        ("--voigt", "2.1333333333333333,0.53333333333333333,0,2.1333333333333333,0,0.8", False),
        ("--compliance", "0.5,-0.125,0,0.5,0,1.25", False),
    ],
)
def test_a_solid_is_the_same_in_every_form(form, text, strain):
    # Plane strain of E = 1.875, ν = 0.2: E/(1 − ν²) and ν/(1 − ν) of plane stress, another shear.
    wanted = materials.isotropic(0.25) * (2.0 if not strain else 1.953125)
    np.testing.assert_allclose(tensor(form, text, strain, 30.0), wanted, atol=1e-12)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ([], "give one solid"),
        (["silicon", "--voigt", "1,0,0,1,0,1"], "give one solid"),
        (["slicon"], "no solid is called"),
        (["--voigt", "1,2"], "takes 6 numbers"),
        (["--isotropic", "1;0.3"], "numbers with commas"),
        (["--isotropic", "1,0.7", "--strain"], "Poisson's ratio"),
        (["--voigt", "1,2,0,1,0,1"], "not positive definite"),
        (["--voigt", "nan,0,0,1,0,1"], "not finite"),
        (["silicon", "--m", "0"], "horizon"),
        (["silicon", "--m", "nan"], "horizon"),
        (["silicon", "--density", "-1"], "density"),
        (["silicon", "--angle", "inf"], "--angle"),
        (["silicon", "--strain"], "--strain"),
        (["silicon", "--out", "x.bmp"], ".png"),
        (["missing.toml"], "cannot be read"),
        ([str(EXAMPLES / "disc.toml")], "no elastic solid"),
    ],
)
def test_what_makes_no_sense_is_refused_in_one_line(given, message):
    found = cli.invoke(app, ["material", *given])
    assert found.exit_code == 2, found.output
    assert message in found.output
    assert len(found.output.strip().splitlines()) == 1


def test_the_command_prints_draws_and_writes(tmp_path):
    given = ["material", str(EXAMPLES / "cantilever.toml"), "--m", "3",
             "--out", str(tmp_path / "a.svg"), "--json", str(tmp_path / "a.json")]  # fmt: skip
    found = cli.invoke(app, given)
    assert found.exit_code == 0, found.output
    for word in ("micromoduli", "margin", "kink", "wave", "hole", "crack", "Use calibration"):
        assert word in found.output
    told = json.loads((tmp_path / "a.json").read_text(encoding="utf-8"))
    assert len(told["kinks"]["angle"]) == 19
    assert told["margins"]["horizons"] == list(HORIZONS)
    assert (tmp_path / "a.svg").read_text(encoding="utf-8").startswith("<?xml")
    again = cli.invoke(app, given)
    assert (again.exit_code, "already" in again.output) == (2, True)


def test_a_page_of_solids_beside_the_report(glass, ply, tmp_path, monkeypatch):
    from cmverify.report.build import BESIDE
    from cmverify.studies.anisotropy import page

    assert page.NAME in dict(BESIDE)
    # The cases' own solids take a minute.
    monkeypatch.setattr(page, "of_the_cases", lambda: iter([("glass", glass), ("ply", ply)]))
    monkeypatch.setattr(
        "cmverify.studies.anisotropy.profile.profile", lambda name, found, *_: found
    )
    done = cli.invoke(app, ["material", "--page", str(tmp_path)])
    assert done.exit_code == 0, done.output
    text = (tmp_path / page.NAME).read_text(encoding="utf-8")
    assert text.count("<img") == 2
    assert glass.advice[:40] in text.replace("&#39;", "'")
    assert "cmverify material --m 5 --page" in text
    assert len(text) < 1_000_000
    again = cli.invoke(app, ["material", "--page", str(tmp_path)])
    assert (again.exit_code, "already" in again.output) == (2, True)


def test_the_solids_of_the_cases_are_solids():
    from cmverify.studies.anisotropy.page import of_the_cases

    solids = dict(of_the_cases())
    assert set(materials.TENSORS) < set(solids)
    assert all(np.linalg.eigvalsh(voigt).min() > 0 for voigt in solids.values())
