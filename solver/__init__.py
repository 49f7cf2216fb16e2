"""Fields of continuum-molecular (micropolar bond-based peridynamic) scenes."""
