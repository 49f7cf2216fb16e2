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
`lamb`                 edge of a half-plane under a pulse of pressure
`crack_series`         eigenfunctions of a crack tip in an anisotropic body
`crack_pair`           two collinear cracks in an infinite plane
`interaction`          stress intensity factors by the interaction integral
`toughness`            fracture energy of bonds that a straight cut breaks
`inclusion`            disc of another solid in an infinite plane, conduction and elasticity
`cosserat`             size effects of polar strips, shear waves of polar solids
`thermal`              thermal stress in a free disc
`thermoelastic`        adiabatic changes, thermoelastic damping
`piezoresistive`       conductivity of a continuum whose directions conduct by their stretch
=====================  ======================================================================
"""

from references.analytic import (
    christoffel,
    compact_tension,
    conduction,
    cosserat,
    crack_pair,
    crack_series,
    elasticity,
    hole,
    inclusion,
    interaction,
    kinking,
    lamb,
    lekhnitskii,
    piezoresistive,
    potential_drop,
    tetrachiral,
    thermal,
    thermoelastic,
    toughness,
    voigt,
)

__all__ = [
    "christoffel",
    "compact_tension",
    "conduction",
    "cosserat",
    "crack_pair",
    "crack_series",
    "elasticity",
    "hole",
    "inclusion",
    "interaction",
    "kinking",
    "lamb",
    "lekhnitskii",
    "piezoresistive",
    "potential_drop",
    "tetrachiral",
    "thermal",
    "thermoelastic",
    "toughness",
    "voigt",
]
