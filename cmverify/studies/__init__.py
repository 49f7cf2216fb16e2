"""Studies beside the cases: which solids are stable, and what speed costs."""
