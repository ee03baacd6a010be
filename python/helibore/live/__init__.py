"""Build a wall while drilling: store data from WITS or a WITSML store in a journal, and add them to the wall."""
