"""What several cases share: materials, scenes, adapters, stress intensity factors."""
