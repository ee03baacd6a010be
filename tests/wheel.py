"""What an installed portable wheel must be: ``python tests/wheel.py avx512`` in an environment that has it alone."""

import sys
from pathlib import Path

import helibore as hb
from helibore import _core

package = Path(hb.__file__).parent
assert _core.instruction_set_in_use() == sys.argv[1], f"it uses {_core.instruction_set_in_use()}, not {sys.argv[1]}"
assert not [*package.rglob("*.a"), *package.rglob("*.hpp")], "libraries and headers are for hosts, not for this wheel"
size = sum(file.stat().st_size for file in package.rglob("*") if file.is_file() and "page" not in file.parts)
rows = range(5000)
wall = hb.reconstruct(
    hb.Caliper([1000 + i * 0.001 for i in rows], [i * 37 % 360 for i in rows], [0.11] * 5000), bit_diameter=0.216
)
assert wall.radius.min() == wall.radius.max() == 0.11
extension = Path(_core.__file__)
print(f"{extension.name}: {extension.stat().st_size / 1e6:.1f} MB, {_core.instruction_set_in_use()}")
print(f"the package without the page: {size / 1e6:.1f} MB")
