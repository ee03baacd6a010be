"""Surfaces, volumes and their file formats."""
