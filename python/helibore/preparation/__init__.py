"""From readings to samples that a wall can trust."""
