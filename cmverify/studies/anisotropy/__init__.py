"""What a researcher wants to know of a solid before choosing a model of it."""
