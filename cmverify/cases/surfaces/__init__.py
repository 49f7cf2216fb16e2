"""Free surfaces: tractions and flux on edges, discs, holes, crack faces, by every treatment."""

from cmverify.case import Case
from cmverify.cases.surfaces.centre_crack import CASES as CRACKS
from cmverify.cases.surfaces.homogeneous import CASES as HOMOGENEOUS
from cmverify.cases.surfaces.isotropic import CASES as ISOTROPIC
from cmverify.cases.surfaces.pulled_plate import CASES as PULLED
from cmverify.cases.surfaces.round import CASES as ROUND

CASES: tuple[Case, ...] = (*HOMOGENEOUS, *ROUND, *PULLED, *CRACKS, *ISOTROPIC)
