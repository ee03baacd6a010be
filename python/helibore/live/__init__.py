"""While drilling: measurements arrive over WITS, are stored, and the wall grows."""
