"""The tetrachiral cases hold, and see one per cent of stiffness."""

from cmverify.cases.modes import tetrachiral
from cmverify.judge.verdict import judge


def failed(case, method, measurements):
    verdicts = judge(case, {method: measurements})
    return {(v.quantity, v.kind) for v in verdicts if not v.passed}


def test_free_modes_see_one_per_cent():
    free = tetrachiral.CASES[0]
    assert not failed(free, "bond/m=5", {14: tetrachiral.bond(5, "free", "extrapolated", 14)})
    stiff = tetrachiral.bond(5, "free", "extrapolated", 14, stiffer=1.01)
    assert ("first", "bound") in failed(free, "bond/m=5", {14: stiff})


def test_clamped_modes_see_one_per_cent_and_an_edge_left_free():
    clamped = tetrachiral.CASES[1]
    assert not failed(clamped, "bond/edge", {14: tetrachiral.bond(5, "edge", "extrapolated", 14)})
    soft = tetrachiral.bond(5, "edge", "extrapolated", 14, stiffer=0.99)
    assert ("first", "bound") in failed(clamped, "bond/edge", {14: soft})
    free = tetrachiral.bond(5, "free", "extrapolated", 14)
    assert ("rigid", "equal") in failed(clamped, "bond/edge", {14: free})


def test_blocks_and_homogenised_solid_agree():
    free = tetrachiral.CASES[0]
    measured = tetrachiral.blocks(False, 25)
    assert not failed(free, "block lattice", {25: measured})
    assert measured.quantities["blocks"] < 1e-9
    # Of another number of cells: not the same square.
    assert ("frequency", "bound") in failed(
        free, "block lattice", {25: tetrachiral.blocks(False, 24)}
    )


def test_the_horizon_stays_near_five_quarters_of_a_block():
    # 25ℓ = 25 a / cos β, tan β = 1/2.
    side = 25 * (1.25**0.5)
    for m, cells in tetrachiral.HORIZON.items():
        assert abs(side / cells * m / 1.25 - 1) < 5e-3
