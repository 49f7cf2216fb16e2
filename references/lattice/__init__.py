"""Rigid blocks on elastic interfaces: exact reference for the tetrachiral solid."""
