"""The walls, images and path that the records give."""
