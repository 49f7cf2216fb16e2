"""Independent truth: closed forms, finite elements, the block lattice, errata."""
