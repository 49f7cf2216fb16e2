"""A second finite-element code, FEniCSx, in a process of its own."""
