"""The errors of Python for a zip archive that is cut, damaged, encrypted, or packed in an unknown way."""

import struct
import zipfile
import zlib

DAMAGED_ZIP = (zipfile.BadZipFile, EOFError, RuntimeError, struct.error, zlib.error)
"""RuntimeError is for a member that is encrypted; NotImplementedError, for an unknown way of packing, is one, too."""
