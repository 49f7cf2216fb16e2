"""Bodies: regions, their particles, their outline, and every question of place."""
