"""Solids and bonds: tensors, families, laws, calibrated moduli, and which of them are stable."""
