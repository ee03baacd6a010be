"""helibore: the wall of a borehole, rebuilt from scattered measurements on a uniform helix.

The public names are those of ``__init__.pyi``; each is imported when it is first used.
"""

import logging

import lazy_loader

from helibore._core import __version__ as __version__
from helibore.base.tables import LogTable

__getattr__, _, __all__ = lazy_loader.attach_stub(__name__, __file__)
__all__.remove("open")  # a star import must not replace the built-in function


def __dir__():
    return sorted({*globals(), *__all__, "open"})


def _save_table(table, filename):
    from helibore.files.log_files import save_table

    save_table(table, filename)


LogTable.writer = staticmethod(_save_table)  # tables lie below the formats of files and do not know them
logging.getLogger(__name__).addHandler(logging.NullHandler())
