"""Faults that one case alone catches, and why no second one does."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from cmverify.report.wording import counted

if TYPE_CHECKING:
    from cmverify.faults.table import Result

#: What is said of faults that nothing is said of here.
UNKNOWN = "no second case that sees it is known"

#: Why one case alone sees faults, and their names.
ALONE: dict[str, tuple[str, ...]] = {
    "elements beside a scene are a user's: one case compares them, the others have elements of "
    "their own": (
        "loads of elements beside a scene + 1 %",
        "stiffness of elements beside a scene + 1 %",
        "what elements beside a scene are held at + 1 %",
        "stress of elements beside a scene of the other sign",
        "loads beside a scene left out",
        "differences from elements halved",
        "modes paired with the next",
        "cross-checks that always hold",
    ),
    "elements in time serve users' scenes and stored references: at quick no other case calls "
    "them": (
        "mass of finite elements + 1 %",
        "motion of finite elements without damping",
        "heat capacity of finite elements in time + 1 %",
    ),
    "other cases at quick have bodies of one solid, or judge these inclusions by what "
    "does not feel it": (
        "interfaces shifted by 2 %",
        "stress around an inclusion + 1 %",
        "the other solid's bonds + 1 %",
        "rotations shared across interfaces",
        "thickness of inclusions + 1 %",
        "thickness of a bond the same mean of all its cells",
        "finite elements of the bimetal + 1 %",
        "curvature of a bimetal + 1 %",
    ),
    "a reference that one case alone is held against; its closed form has no other use at quick": (
        "K of a pair of cracks + 25 %",
        "potential drop of slits + 10 %",
        "intensity of edge cracks + 2 %",
        "stored stiffness of pinned bodies + 8 %",
        "stored K_I of pinned bodies + 10 %",
        "stored displacement at a hole + 1 %",
        "stored stress at a hole + 1 %",
        "displacement around a finite crack + 1 %",
        "K of a finite crack + 2 %",
        "stored kink factors + 1 %",
        "frequencies of blocks + 1 %",
        "turns of blocks + 2 %",
        "apparent shear modulus + 5 %",
        "bending of a polar strip + 1 %",
        "stress of the heated disc + 1 %",
        "frequencies of finite elements + 1 %",
        "quartic moments of the continuum + 1 %",
        "strained conductivity of the continuum + 1 %",
        "adiabatic temperature + 1 %",
        "adiabatic temperature of the other sign",
        "finite-element stress + 1 %",
    ),
    "what a case prescribes and what it judges come from the same closed form, so that a "
    "per cent cancels or lies within the method's own error: identities of the form see "
    "it, exactly": (
        "polarisations of the two waves exchanged",
        "impulse response + 1 %",
        "displacement of the half space + 1 %",
        "heat of a pulse spreads 1 % too slowly",
        "crack-tip displacement + 1 %",
        "crack-tip stress + 1 %",
        "crack-tip rotation + 1 %",
        "displacement about a hole + 1 %",
        "hoop stress of a hole + 1 %",
        "hoop intensity factors + 1 %",
        "hoop kink angle + 5 degrees",
        "exponential temperature + 1 %",
        "temperature of a point source + 1 %",
        "temperature of a heat pulse + 1 %",
        "stiffness of isotropic solids + 1 %",
        "wave speeds + 1 %",
        "compact tension shape factor + 1 %",
        "potential drop + 1 %",
        "finite elements' tractions + 1 %",
        "kink angle of largest release + 5 degrees",
        "release rate of kinks + 1 %",
        "body force of a polynomial + 1 %",
    ),
    "an effect that one case alone has at quick: deformation that heats, conductors that "
    "are strained, heat that a current makes in a bar, cracks that are sensed or driven "
    "by temperatures, leads that are fed or left floating, pins that turn": (
        "thermal forces and their adjoint + 2 %",
        "thermoelastic loss - 15 %",
        "gauge of bonds + 1 %",
        "what the actual length adds to a gauge left out",
        "factor of bonds squared",
        "stretch of bonds + 1 %",
        "bonds at the surface not strained",
        "bonds at the surface conduct 1 % more",
        "heat of bonds + 1 %",
        "energies at the surface + 1 %",
        "drop of a sensor that grows with itself",
        "expansion does half its work",
        "leads without a rim",
        "Joule heat halved",
        "current of a lead + 1 %",
        "no conductor floats",
        "pins that do not turn",
    ),
    "tips are calibrated in one case alone: elsewhere they stay as the paper draws them": (
        "fields of calibrated tips turned by 5 degrees",
        "rotation of calibrated tips' fields of the other sign",
        "forces that calibrate tips halved",
        "tips turned over without their signs",
        "tips left as drawn without a word",
        "calibrated tips with half their stiffness",
        "calibrated tips of the other sign",
    ),
    "it is a judge itself: only numbers that are known otherwise can judge it": (
        "every error halved",
        "every error + 1 %",
        "the worst of errors passes over NaN",
        "the worst of errors + 1 %",
        "energies of strains + 1 %",
        "no non-negative moduli ever",
    ),
    "answers of other programs are no case's of ours: one case makes some whose error is known": (
        "distances between lines + 1 %",
        "largest deviations + 1 %",
        "rigid motions counted as errors",
        "answers taken from the nearest particle",
        "answers carried across cracks",
        "answers on triangles + 1 %",
        "answers in time + 1 %",
    ),
    "fields are judged inside bodies, and the place that is spoilt lies there in one case alone": (
        "one energy density NaN",
    ),
    "growth of cracks at quick is judged to some per cent, its first bonds to rounding": (
        "bonds break 2 % too late",
        "advance + 5 %",
    ),
    "laws of toughness are counted bond by bond in one case; growth at quick has constant "
    "toughness": (
        "influence moment + 1 %",
        "effective fracture energy + 1 %",
        "levelled bonds not levelled",
        "one direction of bonds 5 % too tough",
    ),
    "the other cases that call it compare two answers to the same loads, or prescribe so "
    "much that a per cent of a load is hardly felt": (
        "heat source + 1 %",
        "heat source of the other sign",
    ),
    "users ask for it, figures draw it: nothing that is solved depends on it": (
        "values at corners of cells + 1 %",
        "cells joined across cracks",
        "compliance + 1 %",
        "material axis off by 1 degree",
    ),
    "in the other cases that move, an error of the first order in the step stays below "
    "that of the lattice at quick, or no such mode exists": (
        "first half step left out",
        "steps of heat 1 % too long",
        "a rigid motion counted twice",
    ),
    "cracks of the other cases at quick grow straight on": ("paths of cracks mirrored",),
    "displacements of edges are judged to some per cent elsewhere, as waves at quick allow": (
        "surface displacement + 1 %",
    ),
    "the other case with thermal strains has one that is isotropic, breaks nothing and "
    "errs by as much itself, or is in plane stress": (
        "thermal strain of ended bonds + 1 %",
        "thermal forces at surfaces + 1 %",
        "total strain breaks bonds",
        "expansion along 1 and 2 swapped",
        "plane stress expansion in plane strain",
    ),
}


def why(name: str) -> str:
    """Why one case alone catches the fault of that name; empty if nothing is said of it."""
    return next((reason for reason, faults in ALONE.items() if name in faults), "")


@dataclass(frozen=True)
class Tally:
    """How many faults are caught by how many cases.

    Attributes
    ----------
    total, caught, twice, argued : int
        Faults; those that a case catches; that two or more catch; that are argued to be harmless.
    groups : dict
        Results of those that one case catches, by why it is alone.
    """

    total: int
    caught: int
    twice: int
    argued: int
    groups: dict[str, list[Result]]

    @classmethod
    def of(cls, results: Sequence[Result]) -> Tally:
        """Of results."""
        groups: dict[str, list[Result]] = {}
        for result in results:
            if len(result.cases) == 1 and not result.fault.harmless:
                groups.setdefault(why(result.fault.name) or UNKNOWN, []).append(result)
        return cls(
            len(results),
            sum(bool(r.cases) for r in results),
            sum(len(r.cases) > 1 for r in results),
            sum(r.good and not r.cases for r in results),
            groups,
        )

    def sentence(self, once: bool) -> str:
        """In words; `once` if no second case was asked."""
        verb = "is" if self.total == 1 else "are"
        found = f"{self.caught} of {counted(self.total, 'fault')} {verb} caught"
        if not once:
            found += f", {self.twice} of them by two cases or more"
        if self.argued:
            verb = "is" if self.argued == 1 else "are"
            found += f"; {self.argued} more {verb} argued to be harmless"
        return f"{found}."
