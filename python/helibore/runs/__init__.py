"""From files to outputs, repeatable."""
