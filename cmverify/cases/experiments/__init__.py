"""Fracture experiments, the paper's and a pair of cracks: bodies loaded until they part."""

from . import bone, inclusion, notched_plate, pair

CASES = (*inclusion.CASES, *notched_plate.CASES, *bone.CASES, *pair.CASES)
