"""What ``hb.open`` returns: a LogFile of LogSets, whose channels become readings, a survey or sector images.

LogFile  --set-->  LogSet  --roles-->  Readings, Caliper, Survey, RawSectorImage
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from helibore.base.errors import InputError
from helibore.channels import columns
from helibore.channels.channel_readings import readings
from helibore.channels.columns import RawSectorImage
from helibore.channels.roles import RoleMap
from helibore.files.raw_set import Channel, RawSet
from helibore.preparation.readings import Readings
from helibore.samples.caliper import Caliper
from helibore.trajectory.survey import Survey

if TYPE_CHECKING:
    from helibore.settings.preparation_settings import Echo


class LogSet(RawSet):
    """Channels with one index, such as a LAS data section, a DLIS frame or a table; sector columns are one image.

    It has the attributes of a `RawSet`. In ``channels``, an image stands in the place of its first column.
    """

    def caliper(self, roles: RoleMap | None = None, bit_diameter: float | None = None) -> Caliper:
        """Return the wall samples as a `helibore.Caliper`. An error about an impossible radius names its line or row.

        ``roles`` and ``bit_diameter`` (m) as in `readings`.
        ``helibore.prepare(file.readings(), ...)`` conditions, corrects and merges the readings first.
        """
        from helibore.preparation.prepare import prepare

        return prepare(self.readings(roles, bit_diameter)).caliper

    readings = readings
    survey = columns.survey
    image = columns.image


class LogFile:
    """An opened file: its format and the sets it holds.

    A file with one set can be used as that set (``file["GR"]``, ``file.caliper()``). If a file has several sets, choose
    one by ``file.set("name").survey()`` or by the set that a role map names.
    """

    def __init__(
        self, path: Path, format_name: str, sets: Sequence[LogSet], close: Callable[[], object] = lambda: None
    ) -> None:
        self.path, self.format, self.sets, self._close = path, format_name, tuple(sets), close

    def set(self, name: str | None = None) -> LogSet:
        """Return the set with the name ``name``, or the only set if ``name`` is None.

        An InputError lists the sets if no set has the name, or if there are several sets and ``name`` is None.
        """
        names = ", ".join(repr(each.name) for each in self.sets)
        if name is None:
            if len(self.sets) == 1:
                return self.sets[0]
            raise InputError(self.path.name, f"holds {len(self.sets)} sets: name one of {names}")
        for each in self.sets:
            if each.name == name:
                return each
        raise InputError(self.path.name, f"no set {name!r}; it holds {names}")

    def _set_of(self, roles: RoleMap | None) -> LogSet:
        return self.set(roles.set_name if roles else None)

    def __getitem__(self, name: str) -> Channel:
        return self.set()[name]

    def __contains__(self, name: object) -> bool:
        return name in self.set()

    def __iter__(self) -> Iterator[Channel]:
        return iter(self.set())

    @property
    def channels(self) -> Sequence[Channel]:
        """Channels of the only set."""
        return self.set().channels

    def caliper(self, roles: RoleMap | None = None, bit_diameter: float | None = None) -> Caliper:
        """Return `LogSet.caliper` of the only set, or of the set that ``roles`` names; ``bit_diameter`` in metres."""
        return self._set_of(roles).caliper(roles, bit_diameter)

    def readings(
        self, roles: RoleMap | None = None, bit_diameter: float | None = None, echo: Echo | None = None
    ) -> Readings:
        """Return `LogSet.readings` of the only set, or of the set that ``roles`` names.

        ``bit_diameter`` (m) and ``echo`` as there.
        """
        return self._set_of(roles).readings(roles, bit_diameter, echo)

    def survey(self, roles: RoleMap | None = None) -> Survey:
        """Return `LogSet.survey` of the only set, or of the set that ``roles`` names."""
        return self._set_of(roles).survey(roles)

    def image(self, name: str, roles: RoleMap | None = None) -> RawSectorImage:
        """Return `LogSet.image`, called ``name``, of the only set, or of the set that ``roles`` names."""
        return self._set_of(roles).image(name, roles)

    def close(self) -> None:
        """Close the file. Loaded values remain available."""
        with suppress(OSError):
            self._close()

    def __enter__(self) -> LogFile:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<LogFile {self.path.name}: {self.format}, {len(self.sets)} set(s)>"
