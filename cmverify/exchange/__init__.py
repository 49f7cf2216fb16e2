"""Scenes from files, fields to files."""
