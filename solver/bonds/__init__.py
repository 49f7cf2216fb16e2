"""Bonds of a body: which exist, what ends at the surface, how they strain (Eqs. 1–3)."""
