"""Errors that name the physics: each says what is wrong with the model, not with an array."""


class SceneError(ValueError):
    """What a scene asks for cannot be: an empty region, a rigid mode left free, a wrong key."""


class EmptyRegionError(SceneError):
    """Shapes that lie apart have nothing in common, or a hole takes all of a body."""


class NoOutlineError(SceneError):
    """A region does not say where its edges run, and something needs to know."""


class CalibrationError(ValueError):
    """No micromoduli of the wanted kind reproduce the given tensor on the given family."""


class NotRepresentableError(CalibrationError):
    """No non-negative bond moduli make the tensor on this family; another m may have them."""


class InadmissibleMaterialError(ValueError):
    """The condensed symbol is negative at some wave vector: the solid is unstable in bulk."""


class NegativeCurvatureError(RuntimeError):
    """A solver met a direction of non-positive energy in an operator taken to be positive."""


class ConvergenceError(RuntimeError):
    """An iterative solver stopped before it reached the tolerance asked for."""


class MechanismError(SceneError):
    """A part of the body can move without straining a bond."""


class ToughnessError(ValueError):
    """Fracture energies of no material, or that no non-negative bond energies give."""
