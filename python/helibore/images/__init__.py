"""Sector images: rows of values around the hole."""
