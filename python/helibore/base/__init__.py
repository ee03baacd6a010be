"""What every folder may use. It does not know about boreholes."""
