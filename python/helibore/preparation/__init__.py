"""Turn readings into samples in one frame, checked and corrected, from which a wall is rebuilt."""
