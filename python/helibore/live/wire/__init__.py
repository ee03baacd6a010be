"""The bytes of a peer: addresses, links, and what they carry."""
