"""Stiffness of a body as products with fields, assembled where somebody needs the matrix."""
