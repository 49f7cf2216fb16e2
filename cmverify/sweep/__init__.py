"""One scene file at every point of a grid of settings: declared, run, kept, tabled."""
