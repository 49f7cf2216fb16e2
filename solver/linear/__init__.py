"""Krylov methods and the two-level preconditioner, for every analysis."""
