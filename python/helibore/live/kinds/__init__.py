"""The kinds of sources: each module here that has a KIND is one."""
