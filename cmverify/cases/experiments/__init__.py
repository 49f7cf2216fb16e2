"""The paper's fracture experiments: bodies that are loaded until they part."""

from . import bone, inclusion, notched_plate

CASES = (*inclusion.CASES, *notched_plate.CASES, *bone.CASES)
