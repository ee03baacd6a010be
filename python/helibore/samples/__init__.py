"""What a wall is made of: calipers and the helix."""
