"""Settings: what a user may choose, each declared once with its unit, rule and explanation."""
