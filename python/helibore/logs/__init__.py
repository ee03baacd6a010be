"""What each turn of a wall measures, and what that means."""
