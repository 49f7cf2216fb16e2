"""Finite-element references: scikit-fem on gmsh meshes."""
