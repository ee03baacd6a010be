"""Arrays, units, colours, errors and files: code that every folder may use and that does not know about boreholes."""
