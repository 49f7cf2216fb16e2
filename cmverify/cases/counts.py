"""How many particles the lattice puts into the discs of the paper."""

from __future__ import annotations

from cmverify.case import Case, Check, Level, Measurement, Method

#: The paper prints the first three (Sects. 2.3.1, 4.3.1) and 45344 for a/120, where centres at
#: half-integer multiples of the spacing inside the circle give 45244: count them.
COUNTS = {30: 2828.0, 60: 11304.0, 100: 31428.0, 120: 45244.0}
LADDER = dict.fromkeys(Level, tuple(COUNTS))


def count(n: int) -> Measurement:
    """Particles of the solver's lattice in a disc of radius a at spacing a/n."""
    from solver import disc
    from solver.geometry import Lattice

    lattice = Lattice(disc(1.0), 1.0 / n, 5)
    return Measurement(lattice.count, {"particles": float(lattice.count)})


CASES = (
    Case(
        name="particle-counts",
        title="Particles in the discs of the paper",
        section="Sects. 2.3.1 and 4.3.1",
        tags=("counts",),
        shows=(
            "Centres at half-integer multiples of the spacing reproduce the paper's numbers of "
            "particles; its 45,344 at a/120 is a misprint of 45,244."
        ),
        methods=(Method("bond/lattice", "bond", count, LADDER),),
        checks=(
            Check(
                "bond/lattice",
                "particles",
                equals=COUNTS,
                source="printed in Sects. 2.3.1 and 4.3.1, the last counted by hand",
            ),
        ),
        quantities={"particles": "particles in the disc"},
        primary="particles",
        featured="bond/lattice",
        timed=False,
    ),
)
