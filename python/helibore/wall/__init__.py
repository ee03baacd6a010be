"""The wall of a hole, its archive, and values interpolated with its samples."""
