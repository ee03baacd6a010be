"""While drilling: measurements arrive over WITS or from a WITSML store, are journalled, and the wall grows."""
