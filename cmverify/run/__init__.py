"""Cases measured, each by itself, and what is kept of it."""
