"""The configuration of a WITSML store: which log and trajectory are polled, and what the curves mean.

    [source.store]
    address = "https://store.example/witsml"
    log = { well = "w-7", wellbore = "b-1", log = "caliper", index = "depth" }
    trajectory = { well = "w-7", wellbore = "b-1", trajectory = "plan" }
    items = { bit_depth = "DBTM" }
    caliper = { toolface = ["TF1"], radius = ["R1"] }

Curves are named by mnemonic; their units come with them. Inside, each curve has a number as a WITS item has a code.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from helibore.base import units
from helibore.images.sector_image import Reference
from helibore.live.layout import read_layout
from helibore.live.pass_rules import read_pass_numbers
from helibore.live.tables import Table

if TYPE_CHECKING:
    from helibore.live.configuration import Source

NULLS = (-999.25, -9999.0)
JUMPS = {"depth": 30.0, "time": 3600.0}
INDEX = 1
"""The number of the index curve, whatever its mnemonic."""
KINDS = {"bit_depth": units.LENGTH, "hole_depth": units.LENGTH, "rotation": units.ROTATION, "activity": ""}


@dataclass(frozen=True)
class Access:
    """How the store is reached. The password itself is read from the environment when it is needed, and never kept."""

    user: str
    password_env: str
    ca: str
    timeout: float
    answer_bytes: int


@dataclass(frozen=True)
class Curve:
    """A curve of the log: its mnemonic, what its unit must measure or how it must be written ("": any)."""

    mnemonic: str
    kind: str
    unit: str = ""


@dataclass(frozen=True)
class Store:
    """What is polled: uids of well, wellbore and object; ``curves[n]`` has the number n + 2.

    A row more than ``jump`` (m or s) behind the one before it counts when the next row lies within ``jump`` of it.
    """

    access: Access
    log: tuple[str, str, str] | None
    index: str
    jump: float
    trajectory: tuple[str, str, str] | None
    curves: tuple[Curve, ...]

    def meaning(self) -> dict[str, Any]:
        """Return what decides the wall, without how the store is reached."""
        meaning = {key: value for key, value in asdict(self).items() if key != "access"}
        for curve in meaning["curves"]:
            del curve["unit"]  # the image's
        if self.jump == JUMPS[self.index]:
            del meaning["jump"]
        return meaning


class Numbers:
    """Gives each mnemonic its number, in the order they are first named."""

    def __init__(self) -> None:
        self.curves: list[Curve] = []

    def number(self, table: Table, name: str, mnemonic: Any, kind: str, unit: str = "") -> int:
        """Return the number of ``mnemonic``."""
        if not isinstance(mnemonic, str) or not mnemonic.strip():
            raise table.fail(name, mnemonic, "must be the mnemonic of a curve")
        for place, curve in enumerate(self.curves):
            if curve.mnemonic == mnemonic:
                if (curve.kind, curve.unit) != (kind, unit):
                    raise table.fail(name, mnemonic, "is mapped to another quantity too")
                return place + 2
        self.curves.append(Curve(mnemonic, kind, unit))
        return len(self.curves) + 1


def read_store(name: str, table: Table, bit_diameter: float, reference: Reference) -> Source:
    """Take the table of a source whose address is https."""
    from helibore.live.address import read_address
    from helibore.live.configuration import Item, Source

    address = read_address(table)
    access = _access(table)
    log, index, jump = _log(table.table("log")) if table.has("log") else (None, "depth", JUMPS["depth"])
    trajectory = _uids(table.table("trajectory"), "trajectory") if table.has("trajectory") else None
    if log is None and trajectory is None:
        raise ValueError(f"source.{name}: log or trajectory must be set: what is polled")
    numbers = Numbers()
    items = table.table("items")
    rig = {key: Item(numbers.number(items, key, items.take(key, "", ""), kind))
           for key, kind in KINDS.items() if items.has(key)}  # fmt: skip
    pass_number = None
    if items.has("pass_number"):
        pass_number = Item(numbers.number(items, "pass_number", items.take("pass_number", "", ""), ""))
    items.close()
    caliper = _caliper(table.table("caliper"), numbers, index, bit_diameter) if table.has("caliper") else None
    images = tuple(_image(key, inner, numbers, index, reference) for key, inner in table.tables("image").items())
    if numbers.curves and log is None:
        raise ValueError(f"source.{name}.log: must be set: {numbers.curves[0].mnemonic} is a curve of it")
    source = Source(
        name=name,
        address=address,
        allow=(),
        mode="listen",
        every=table.number("every", 10.0, least=0.05, most=3600),
        units="sent",
        nulls=tuple(table.array("nulls", float, list(NULLS))),
        limits=(1024, 65536, 512),
        silence=table.number("silence", 120.0, least=0.1),
        items=rig,
        caliper=caliper,
        images=images,
        survey=None,
        pass_number=pass_number,
        pass_numbers=read_pass_numbers(table.table("pass_numbers")),
        store=Store(access, log, index, jump, trajectory, tuple(numbers.curves)),
    )
    table.close()
    return source


def _access(table: Table) -> Access:
    if table.has("password"):
        rule = "must not be in the file, which is copied into the journal: name an environment variable in password_env"
        raise ValueError(f"{table.place}.password: {rule}")
    access = Access(
        user=table.text("user", ""),
        password_env=table.text("password_env", ""),
        ca=table.text("ca", ""),
        timeout=table.number("timeout", 30.0, least=0.1, most=600),
        answer_bytes=table.whole("answer_mb", 16, least=1, most=256) << 20,
    )
    if bool(access.user) != bool(access.password_env):
        raise ValueError(f"{table.place}: user and password_env must be set both, or neither")
    return access


def _uids(table: Table, last: str) -> tuple[str, str, str]:
    uids = (table.text("well", why="the uid"), table.text("wellbore", why="the uid"), table.text(last, why="the uid"))
    table.close()
    return uids


def _log(table: Table) -> tuple[tuple[str, str, str], str, float]:
    index = table.choice("index", tuple(JUMPS))
    jump = table.number("jump", JUMPS[index], least=0.001, why="metres or seconds")
    return _uids(table, "log"), index, jump


def _caliper(table: Table, numbers: Numbers, index: str, bit_diameter: float) -> Any:
    from helibore.live.configuration import CaliperItems, Item

    half = 0.5 if table.choice("measures", ("radius", "diameter"), "radius") == "diameter" else 1.0
    kinds = {"toolface": units.ANGLE, "radius": units.LENGTH, "depth": units.LENGTH}
    columns: dict[str, list[int]] = {"depth": []}
    for name, kind in kinds.items():
        if name != "depth" or table.has(name):
            columns[name] = [numbers.number(table, name, text, kind)
                             for text in table.array(name, str, why="mnemonics, one for each sensor")]  # fmt: skip
    count = len(columns["toolface"])
    if not columns["depth"] and index == "depth":
        columns["depth"] = [INDEX] * count
    if not count or count != len(columns["radius"]) or len(columns["depth"]) not in (0, count):
        lengths = {name: len(codes) for name, codes in columns.items()}
        raise ValueError(f"{table.place}: toolface, radius and depth must have equally many curves, not {lengths}")
    limits = table.array("radius_range", float, [bit_diameter / 8, bit_diameter * 2])
    if len(limits) != 2 or not 0 < limits[0] < limits[1]:
        raise table.fail("radius_range", limits, "must be [least, most] in metres, 0 < least < most")
    caliper = CaliperItems(
        toolface=tuple(Item(code) for code in columns["toolface"]),
        radius=tuple(Item(code, half) for code in columns["radius"]),
        depth=tuple(Item(code) for code in columns["depth"]),
        offset=table.number("offset", 0.0, why="metres from the bit up to the sensor"),
        latency=0.0,
        toolface_offset=table.number("toolface_offset", 0.0, least=-360, most=360),
        radius_range=(limits[0], limits[1]),
    )
    table.close()
    return caliper


def _image(name: str, table: Table, numbers: Numbers, index: str, reference: Reference) -> Any:
    from helibore.live.configuration import ImageItems, Item

    unit = table.text("unit", why="the unit of its values, which the store must send")
    sectors = tuple(Item(numbers.number(table, "sectors", text, "", unit))
                    for text in table.array("sectors", str, why="mnemonics, one for each sector"))  # fmt: skip
    if len(sectors) < 2:
        raise table.fail("sectors", len(sectors), "must be 2 mnemonics or more")
    depth = Item(INDEX) if index == "depth" else None
    image = ImageItems(name, unit, sectors, depth, table.number("offset", 0.0), 0.0, read_layout(table, reference))
    table.close()
    return image
