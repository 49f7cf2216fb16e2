"""If the solver or a reference were wrong, would a case say so? Faults put in on purpose."""
