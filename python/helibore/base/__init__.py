"""What every folder may use. It knows nothing of boreholes."""
