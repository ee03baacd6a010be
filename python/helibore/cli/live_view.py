"""``helibore live --view``: show the live wall in the viewer's page.

    the server's drawing thread --show(update)--> Feed of the viewer (a thread of its own) --> pages
    the command's loop -----------refresh()-----> first vertex of the wall; bit depth, path, images, sources, alarms

The page is served before the journal is opened, so that a port in use is an error at the start. Until the wall has a
vertex, the page says what it waits for. The page shows the layer ``main``. The path is extended straight, `AHEAD`
metres below the wall. If there is no path, or if it begins below the top of the wall, the page shows a vertical hole.
The page is from ``helibore/viewer``, which is loaded only with ``--view``.
"""

from __future__ import annotations

import contextlib
import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np

from helibore.base.errors import InputError
from helibore.base.identity import Access
from helibore.base.utc_time import SECOND
from helibore.live.ahead import Outlook
from helibore.live.alarms import Alarm, clock_text, is_connected
from helibore.live.live import Live
from helibore.live.model.update import Update
from helibore.logs.curves import ScalarCurve
from helibore.samples.helix import helix_of

if TYPE_CHECKING:
    from helibore.base.arrays import Floats
    from helibore.trajectory.survey import Path
    from helibore.viewer.channel_strip import ShownChannel
    from helibore.viewer.feed import Feed
    from helibore.wall.wall import Wall

AHEAD = 100.0
"""Metres by which the shown path extends below the wall, so that the path covers the hole that is drilled next."""
IMAGES_SECONDS = 1.0
"""Least seconds between two mappings of the images on the wall; all mappings take at most about 1/20 of the time."""
CHANNELS_SECONDS, PICTURE_SECONDS = 5.0, 1.0
"""Seconds between two updates of the curves of the rig's channels, and of their picture."""
SILENT_SECONDS = 5
"""Seconds after which the picture of the channels is drawn anew although nothing comes: its gap grows."""
STAND = 10.0
"""Metres off bottom up to which the bit is lifted for a connection."""
CORRECTED = 1.0
"""Metres by which the hole depth changes at once if it is another depth of the same hole."""
SHOWN_TIMES = 720
"""The number of latest values by time that the picture shows of a channel: two hours."""


class Window:
    """A page that shows a live wall; it is served at once, at the address ``url``.

    ``well`` is the name on the page; without ``access``, the page is for this machine, with a random token. Errors are
    those of `PageServer` and `check_page`.
    """

    def __init__(self, well: str = "", access: Access | None = None, *, port: int = 0) -> None:
        from helibore.cli.view_command import check_page
        from helibore.viewer.page_server import PageServer
        from helibore.viewer.scene import Scene

        check_page()
        self.scene = Scene()
        self.scene.update_state(sources="Reading the journal.", tripped=True)  # as far as is known
        self._server = PageServer(self.scene, access or Access(), port=port)
        self.url, self.connections = self._server.url, self._server.connections
        self._well = well
        self._live: Live
        self._feed: Feed | None = None
        self._shown: Wall | None = None
        self._path_moved = True
        self._end = self._lead = math.nan  # the end of the wall, and how far the bit was below it at its last sample
        self._hole, self._tripped = math.nan, False
        self._newest: float | None = None
        self._newest_bit: list[int] = []  # the number of the frame of the newest bit depth
        self._apart = 0  # samples of passes that the wall does not take
        self._used = self._stood = 0  # samples that were used, and of a string that did not turn
        self._unused = False
        self._path_stop = float("inf")
        self._images: dict[str, int] = {}  # by image: how many of its rows the page shows
        self._images_due = self._channels_due = self._curves_due = 0.0
        self._curves_size = self._curves_version = 0
        self._since: dict[str, tuple[str, str]] = {}  # by source: its state and since when; until the wall begins

    def follow(self, live: Live) -> None:
        """Make ``live`` the wall that the page shows."""
        self._live = live
        self.scene.read_channels = self._read_channels
        self.connections.report = lambda text: live.report("connections", text)

    def show(self, update: Update) -> None:
        """Pass the changes of ``update`` to the page's thread, and return at once."""
        if update.path_from is not None:
            self._path_moved = True
        if change := update.changes.get(self._live.model.main):
            self._newest = time.time()
            if self._feed and self._shown is self._live.wall:
                self._feed.update(change)

    def refresh(self, states: Mapping[str, str], alarms: Sequence[Alarm] = (), ahead: Outlook | None = None) -> None:
        """Show the wall as soon as it has a vertex; update the bit, the path, the images, the sources and the alarms.

        Call this a few times a second, with the state of each source and what is tight ahead of the bit.
        """
        live = self._live
        unknown = live.model.layouts.keys() - self._images.keys()  # an image that is not configured has begun
        if self._feed and (unknown or self._shown is not live.wall):  # or another hole
            self._feed.close()
            self._feed = None
        if self._feed is None and len(live.wall):
            self._begin()
        elif self._feed and (self._path_moved or self._path_stop < self._span()[1]):
            self._path_moved = False
            self._feed.set_path(self._path())
        if (apart := live.model.apart[live.model.main].values.size) != self._apart:
            self._apart, self._newest = apart, time.time()
            if self._feed:
                self._feed.look_again()
        self._show_images()
        self._show_channels()
        known: dict[str, Any] = {} if self._newest is None else {"newest": self._newest}
        sources = live.configuration.sources
        bits = [name for name, source in sources.items() if "bit_depth" in source.rig]
        newest = live.model.rig.tracks["bit_depth"].order[-1:].tolist()
        at_rest = live.model.rig.at_rest and not any(of.refuses_bit for of in list(live.model.readers.values()))
        if (ages := live.ages()) and (
            at_rest or not (bits and newest and newest == self._newest_bit)  # else no bit depth has come
        ):
            self._newest_bit = newest
            known["received"] = float(round(time.time() - min(ages[name] for name in bits or ages)))
        for name in ("bit_depth", "hole_depth"):
            if received := live.model.rig.tracks[name].value[-1:].tolist():
                known[name] = received[0]
        if "bit_depth" in known and "hole_depth" in known:
            known |= self._follow_hole(known["bit_depth"], known["hole_depth"])
        states_of = ((name, state) for name, state in states.items() if name in sources)
        lost = tuple(name for name, state in states_of if not is_connected(sources[name], state))
        text = "; ".join(f"{name}: {state}" for name, state in states.items())
        if not self._feed:
            text = self._waiting_text(states, alarms, lost)
        fed = [sources[name] for name in bits] or list(sources.values())
        known["units"] = "ft" if fed and fed[0].units == "fps" else "mm"
        known["alarms"] = tuple(alarm.said(named=len(sources) > 1) for alarm in alarms)
        self.scene.update_state(**known, sources=text, unused=self._why_unused(), lost=lost,
                                ahead=asdict(ahead) if ahead else None)  # fmt: skip

    def _follow_hole(self, bit: float, hole: float) -> dict[str, Any]:
        """Return to which hole depth the sensor saw, as it follows the bit, and whether the string was tripped since.

        After a start, the sensor is the configured distance behind the bit, and a bit off bottom may have been tripped.
        """
        on_bottom, by = self._live.model.rig.on_bottom, hole - self._hole
        if abs(by) > CORRECTED:
            self._lead += by  # nothing was drilled
        if by != by or (by > 0.0 and on_bottom):
            self._tripped = not on_bottom
        self._tripped |= hole - bit > STAND
        self._hole = hole
        if self._feed is None:
            return {"tripped": self._tripped}
        end = self._span()[1]
        if end != self._end:
            calipers = [source.caliper for source in self._live.configuration.sources.values() if source.caliper]
            offset = min((caliper.offset for caliper in calipers), default=0.0)
            self._lead = max(offset, bit - end) if end > self._end else offset  # samples come later than the bit depth
            self._end = end
        return {"tripped": self._tripped, "seen_hole": self._end + self._lead}

    def _why_unused(self) -> str:
        """Return why the radii that come are not used: the string does not turn; "" if the latest are, or none came."""
        model, before = self._live.model, (self._used, self._stood)
        self._used, self._stood = model.counts["drawn"] + self._apart, model.counts["flag NOT_ROTATING"]
        if model.rig.turns or self._used > before[0]:
            self._unused = False
        elif self._stood > before[1]:
            self._unused = True
        return f"{'sliding' if model.rig.on_bottom else 'not turning'}: radii not used" if self._unused else ""

    def dead_thread(self) -> str:
        """Return the name of a thread of the page that has ended; "" if all its threads are running."""
        if not self._server.alive:
            return "page"
        return "feed" if self._feed and not self._feed.alive else ""

    def report(self, text: str) -> None:
        """Show on the page why the wall cannot be shown."""
        self.scene.update_state(sources=text)

    def close(self) -> None:
        """Show on the page that the run has ended, and stop serving; a second call does nothing more."""
        self.scene.update_state(ended=True)
        if self._feed:
            self._feed.close()
        self._server.close()

    def __enter__(self) -> Window:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _begin(self) -> None:
        from helibore.viewer import Attribute
        from helibore.viewer.feed import Feed

        self._path_moved = False
        live = self._live
        self._shown = live.wall
        self._images = dict.fromkeys(live.model.layouts, 0)
        configured = [image for source in live.configuration.sources.values() for image in source.images]
        units = {image.name: image.unit for image in configured} | {name: of.unit for name, of in live.images.items()}
        values = np.full(len(live.wall), np.nan)
        attributes: dict[str | Attribute, Floats] = {
            Attribute.usual(name, units.get(name, "")): values for name in self._images
        }
        reference = next((layout.reference for layout in live.model.layouts.values()), None)  # the same for all images
        try:
            feed = Feed(
                self._shown,
                path=self._path(),
                attributes=attributes,
                well=self._well,
                scene=self.scene,
                reference=reference,
                alarmed=live.configuration.alarms.by_kind,
                string=live.configuration.string,
                last_scan=live.model.last_scan,
            )
        except InputError:
            if len(live.wall) == len(values):
                raise
            return  # the wall has grown meanwhile, so the values are too few: the next refresh begins
        feed.start()
        self._feed = feed
        feed.update()  # shows the changes that came during the start

    def _show_images(self) -> None:
        """Map the images that have new rows on the current wall, and show them; at most every `IMAGES_SECONDS`."""
        if self._feed is None or time.monotonic() < self._images_due:
            return
        began, live = time.monotonic(), self._live
        for name, shown in self._images.items():
            rows = len(live.images[name]) if name in live.images else 0
            if rows > max(shown, 1):  # an image of one row has no row spacing, hence no reach
                with contextlib.suppress(InputError):  # no quad of the wall lies under the image yet
                    self._feed.set_attribute(name, live.image(name).on(live.wall))
                    self._images[name] = rows
        self._images_due = time.monotonic() + max(IMAGES_SECONDS, 20 * (time.monotonic() - began))

    def _show_channels(self) -> None:
        """Show the rig's channels: a picture of them, and every `CHANNELS_SECONDS` their curves along the hole."""
        channels = list(self._live.model.channels.by_name.values())
        now = time.monotonic()
        if not channels or now < self._channels_due:
            return
        self._channels_due = now + PICTURE_SECONDS
        silent = int(self._silence()) // SILENT_SECONDS
        self.scene.update_state(channels=max(one.time for one in channels) // SECOND + silent + 2)  # before a value: 1
        if self._feed is None or now < self._curves_due:
            return
        self._curves_due = now + CHANNELS_SECONDS
        curves = [ScalarCurve(one.name, one.unit, *one.by_depth(), one.limits) for one in channels]
        curves = [curve for curve in curves if curve.values.size]
        if (size := sum(curve.values.size for curve in curves)) != self._curves_size:
            self._curves_size, self._curves_version = size, self._curves_version + 1
            self.scene.set_curves(curves, self._curves_version)

    def _silence(self) -> float:
        """Return the seconds since the last bytes of any source, at which the clock of the model stops."""
        return min(self._live.ages().values(), default=0.0)

    def _read_channels(self) -> list[ShownChannel]:
        from helibore.viewer.channel_strip import ShownChannel

        now, found, silence = self._live.model.clock.now, [], self._silence()
        for one in list(self._live.model.channels.by_name.values()):
            times, values = (column[-SHOWN_TIMES:].tolist() for column in one.by_time())
            age = (now - one.time) / SECOND + silence
            found.append(ShownChannel(one.name, one.unit, one.value, age, one.beyond, times, values))
        return found

    def _waiting_text(self, states: Mapping[str, str], alarms: Sequence[Alarm], lost: Sequence[str]) -> str:
        """Return lines on the states of the sources, the samples received, the alarms, and what to check."""
        for name, state in states.items():
            if self._since.get(name, ("", ""))[0] != state:
                self._since[name] = state, clock_text(time.time_ns())
        counts, waiting = self._live.model.counts, self._live.model.waiting
        received, refused = counts["received"], counts["not drawn"]
        text = f"{received:,} samples received"
        text += f", {refused:,} refused" if refused else ""
        text += f", {waiting:,} samples and image rows wait for their depth" if waiting else ""
        unsaid = [alarm for alarm in alarms if alarm.source not in lost or alarm.rule not in ("lost", "no_data")]
        lines = [f"{name}: {state}, since {self._since[name][1]}" for name, state in states.items()]
        lines += [text, *(str(alarm) for alarm in unsaid), *self._advice(lost, received, waiting)]
        return "\n".join(f"{line}." for line in lines)

    def _advice(self, lost: Sequence[str], received: int, waiting: int) -> list[str]:
        """Return what the user should check first: the lost connection, the items that are sent, or the bit depth."""
        for name in lost:
            address = self._live.configuration.sources[name].address
            if address.kind == "listen":
                return [f"Check that the sender of {name} runs and sends to port {address.port} of this machine"]
            place = f"{address.host}:{address.port}" if address.host else address.file
            return [f"Check that {place} is on, sends, and can be reached from this machine"]
        if not received:
            return ["Check that the sender sends, and that the items of the configuration are those that it sends"]
        return ["Check that the bit depth is sent"] if waiting else []

    def _span(self) -> tuple[float, float]:
        """Return the depths of the shallowest and the deepest vertex, metres."""
        wall = self._live.wall
        return helix_of(wall).ends(len(wall))

    def _path(self) -> Path | None:
        """Return the current path, extended below the wall; None without a path, or if it begins below the top."""
        top, bottom = self._span()
        path = self._live.model.stations.reaching(bottom + AHEAD)
        if path is None or path.start_depth > top:
            self._path_stop = float("inf")
            return None
        self._path_stop = path.stop_depth
        return path
