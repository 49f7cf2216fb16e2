"""Which bond models are stable solids: studies of the symbol, their figures, and the command."""
