"""The errors of Python for a zip archive that is cut, damaged, encrypted, or packed in an unknown way."""

import struct
import zipfile
import zlib

DAMAGED_ZIP = (zipfile.BadZipFile, EOFError, RuntimeError, struct.error, zlib.error)
"""A RuntimeError means an encrypted file; its subclass NotImplementedError, a packing that Python does not know."""
