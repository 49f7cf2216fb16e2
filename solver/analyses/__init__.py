"""What is done with a scene."""
