"""Which channel of a file is what, and the readings that follow from it."""
