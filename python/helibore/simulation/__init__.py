"""A simulated hole, the tool that logs it, and the rig that sends it."""
