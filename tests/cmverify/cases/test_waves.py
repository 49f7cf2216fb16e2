"""Wave cases see a stiffness, or a reflection, that is 1 % off."""

from cmverify.cases import waves
from cmverify.judge.verdict import judge

CASES = {case.name: case for case in waves.CASES}


def passed(name, method, measured, n, quantity):
    verdicts = judge(CASES[name], {method: {n: measured}})
    found = [v.passed for v in verdicts if v.quantity == quantity and v.kind == "bound"]
    assert found
    return all(found)


def test_dispersion_sees_one_percent_of_stiffness():
    wrong = waves.disperse(waves.Dispersion(3, distortion=1.01), 20)
    assert not passed("wave-dispersion", "bond/m = 3", wrong, 20, "off the discrete")


def test_reflection_sees_one_percent_of_amplitude():
    wrong = waves.reflect(waves.Lamb("extrapolated", distortion=1.01), 10)
    assert not passed("wave-reflection", "bond/extrapolated", wrong, 10, "amplitude")


def test_lambs_problem_sees_a_wrong_stiffness():
    """Ten per cent stiffer: waves arrive early, all of them."""
    wrong = waves.push(waves.Lamb("extrapolated", distortion=1.1), 10)
    right = waves.push(waves.Lamb("extrapolated"), 10)
    assert wrong.quantities["displacement"] > 2 * right.quantities["displacement"]
