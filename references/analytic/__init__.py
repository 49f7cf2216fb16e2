"""Closed forms, each with its source, units and the identities its tests check.

=====================  ======================================================================
`voigt`                checks and turned axes of 3x3 Voigt tensors
`lekhnitskii`          characteristic roots, crack-tip fields, energy release rate
`kinking`              hoop stress intensity factor and kink angle
`hole`                 circular and elliptical hole in an infinite plate
`elasticity`           polynomial displacement fields in equilibrium, of any degree
`conduction`           anisotropic heat fields: polynomials, exponentials, point sources
`potential_drop`       Johnson's formula for isotropic and orthotropic strips
`compact_tension`      stress intensity factor of ASTM E399
`tetrachiral`          effective tensor of the block lattice
`christoffel`          plane wave speeds
`cosserat`             size effects of polar strips, shear waves of polar solids
`thermoelastic`        adiabatic changes, thermoelastic damping
=====================  ======================================================================
"""

from references.analytic import (
    christoffel,
    compact_tension,
    conduction,
    cosserat,
    elasticity,
    hole,
    kinking,
    lekhnitskii,
    potential_drop,
    tetrachiral,
    thermoelastic,
    voigt,
)

__all__ = [
    "christoffel",
    "compact_tension",
    "conduction",
    "cosserat",
    "elasticity",
    "hole",
    "kinking",
    "lekhnitskii",
    "potential_drop",
    "tetrachiral",
    "thermoelastic",
    "voigt",
]
