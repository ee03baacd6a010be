"""Make outputs from files: build walls of one well or many, and repeat a run from its settings."""
