"""What is asked: supports, loads, checks that all is held, and the scene as arrays."""
