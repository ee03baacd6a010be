from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

__version__: str

class WitsParser:
    def __init__(self, nulls: Sequence[float], line_limit: int, frame_limit: int, item_limit: int) -> None: ...
    def feed(self, bytes: bytes | bytearray | memoryview) -> tuple[int, bytes, _Rows, _Rows, _Rows]: ...
    def finish(self) -> tuple[int, bytes, _Rows, _Rows, _Rows]: ...
    def counts(self) -> dict[str, int]: ...

_Rows = npt.NDArray[np.void]
