"""Stability studies: closed forms, maps and the command, each against something else."""

import re

import numpy as np
import pytest
from typer.testing import CliRunner

from cmverify.cases.common import bond_energies, materials
from cmverify.cli import app
from cmverify.studies.stability import assessments, figures, page, polar, studies
from references.analytic.voigt import turned_axes
from solver import ElasticTensor, Family
from solver.material import calibrate, representable

cli = CliRunner()


def test_bonds_of_the_continuum_calibration_lie_on_the_papers_curves():
    voigt = materials.TENSORS["Fig. 2"]
    family = Family(4, 0.1)
    moduli = calibrate(family, ElasticTensor(voigt), "continuum")
    kn, kt = polar.functions(voigt, family.angle, family.horizon)
    np.testing.assert_allclose(moduli.normal, kn, rtol=1e-12)
    np.testing.assert_allclose(moduli.shear, kt, atol=1e-12 * np.abs(kn).max())
    wrong, _ = polar.functions(1.01 * voigt, family.angle, family.horizon)
    assert not np.allclose(moduli.normal, wrong, rtol=1e-3)


def test_off_axis_moduli_are_those_of_turned_axes():
    voigt = materials.TENSORS["Fig. 2"]
    psi = np.array([0.0, 0.4, 1.3, 2.9])
    axial, shear = polar.off_axis(voigt, psi)
    turned = np.array([turned_axes(voigt, angle) for angle in psi])
    np.testing.assert_allclose(axial, turned[:, 0, 0], rtol=1e-13)
    np.testing.assert_allclose(shear, turned[:, 2, 2], rtol=1e-13)


def test_shear_bonds_vanish_at_one_third():
    (*_, shear) = polar.over_poisson(201).values()
    nu, value = shear
    assert np.all((value > 0) == (nu < 1 / 3))


def test_the_limit_of_plane_strain_separates_stable_from_unstable():
    limit = studies.poisson_limit(3)
    for nu, stable in ((limit - 3e-4, True), (limit + 3e-4, False)):
        found = assessments.judge("", materials.isotropic(nu, "strain"), 3, "lattice")
        assert found.stable == stable
        assert found.confirmed


def test_margins_without_moduli_and_without_rotation_stiffness():
    assert np.isnan(studies.margin(materials.isotropic(0.4), 3, "positive", 8))
    assert np.isneginf(studies.margin(materials.TENSORS["carbon/epoxy"], 3, "continuum", 8))
    assert studies.margin(materials.TENSORS["silicon"], 3, "lattice", 8) == pytest.approx(
        1, abs=1e-2
    )


def test_smallest_horizon_is_the_first_that_represents():
    ply = materials.turned(materials.TENSORS["carbon/epoxy"], 20)
    m = studies.smallest_horizon(ply)
    assert representable(Family(int(m)), ElasticTensor(ply))
    assert not any(representable(Family(k), ElasticTensor(ply)) for k in range(1, int(m)))
    assert np.isinf(studies.smallest_horizon(materials.isotropic(0.4)))


def test_extreme_eigenvalues_bound_those_of_any_wave():
    from solver.material.symbol import symbol

    family = Family(3)
    moduli = calibrate(family, ElasticTensor.isotropic(1.0, 0.45))
    low, high = assessments.extreme_eigenvalues(family, moduli, 48)
    k = np.random.default_rng(0).uniform(-np.pi, np.pi, (300, 2))
    values = np.linalg.eigvalsh(symbol(family, moduli, k))
    assert low < 0 < high
    assert low <= values.min() * 0.98
    assert values.max() <= high * 1.02


def test_a_verdict_that_bond_energies_contradict_is_not_confirmed(monkeypatch):
    monkeypatch.setattr(bond_energies, "is_unstable", lambda *_: True)
    found = assessments.judge("silicon", materials.TENSORS["silicon"], 3, "lattice")
    assert found.confirmed is False
    assert not page.all_confirmed([found])
    assert not page.all_confirmed([])


def test_conductors_are_judged_too():
    found = assessments.compare("1000 : 1", materials.conductivity(1000.0, np.pi / 8), 3)
    assert [v.calibration for v in found] == ["continuum", "lattice", "positive"]
    assert found[-1].kind == "unrepresentable"
    assert found[-1].confirmed


def test_maps_are_drawn_with_every_class():
    margin = np.array([[1.0, -0.3, 0.05], [np.nan, -np.inf, 0.6]])
    one = studies.Map("t", "x", "y", np.array([1.0, 2.0, 4.0]), np.array([1.0, 2.0]), margin)
    figure = figures.maps([one, one], (True, True))
    words = [t.get_text() for t in figure.legends[0].get_texts()]
    assert {"unstable", "unstable: no rotation stiffness", "no such moduli"} <= set(words)
    assert "17 % without such moduli" in page.spoken(margin)


def test_names_of_solids():
    np.testing.assert_allclose(materials.named("isotropic:0.3"), materials.isotropic(0.3))
    strain = materials.named("isotropic:0.3:strain")
    np.testing.assert_allclose(strain, materials.isotropic(0.3, "strain"))
    ply = materials.named("140,10,3,5@90")
    np.testing.assert_allclose(np.diag(ply), [10, 140, 5], rtol=1e-12)
    with pytest.raises(ValueError, match="no solid is called 'wood'"):
        materials.named("wood")


def test_command_writes_a_page(tmp_path):
    given = ["stability", "--material", "carbon/epoxy@30", "--m", "3", "--out", str(tmp_path)]
    found = cli.invoke(app, given, terminal_width=200)
    assert found.exit_code == 0, found.output
    assert "Every verdict is confirmed" in found.output
    text = (tmp_path / "stability.html").read_text()
    assert re.search("data:image/(png|webp);base64,", text)
    assert "inadmissible" in text
    assert (tmp_path / "stability-polar-1.png").is_file()


def test_command_refuses_unknown_solids(tmp_path):
    found = cli.invoke(app, ["stability", "--material", "wood", "--out", str(tmp_path)])
    assert found.exit_code == 2
    assert "no solid is called" in found.output


def test_command_fails_where_nothing_confirms(tmp_path, monkeypatch):
    monkeypatch.setattr(bond_energies, "is_unstable", lambda *_: True)
    given = ["stability", "--material", "silicon", "--m", "2", "--out", str(tmp_path)]
    assert cli.invoke(app, given).exit_code == 1


def test_a_report_links_to_the_page_beside_it(tmp_path):
    from cmverify.report.build import build
    from cmverify.report.summary import RunInfo
    from cmverify.run.environment import describe

    info = RunInfo("quick", 1, 1, "cmverify run", "now", 1.0, describe().as_dict())
    assert "stability.html" not in build([], info, tmp_path).read_text()
    (tmp_path / "stability.html").write_text("x")
    assert 'href="stability.html"' in build([], info, tmp_path).read_text()
