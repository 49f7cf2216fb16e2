"""Hard cases: every sign of the shear stiffness, strong anisotropy, damage, odd lattices, units."""

from cmverify.case import Case
from cmverify.cases.hard.conduction import CASES as CONDUCTION
from cmverify.cases.hard.damage import CASES as DAMAGE
from cmverify.cases.hard.lattices import CASES as LATTICES
from cmverify.cases.hard.mechanisms import CASES as MECHANISMS
from cmverify.cases.hard.poisson import CASES as POISSON
from cmverify.cases.hard.random_tensors import CASES as RANDOM
from cmverify.cases.hard.refusals import CASES as REFUSALS
from cmverify.cases.hard.tensors import CASES as TENSORS

CASES: tuple[Case, ...] = (
    *POISSON,
    *TENSORS,
    *CONDUCTION,
    *RANDOM,
    *REFUSALS,
    *LATTICES,
    *DAMAGE,
    *MECHANISMS,
)
