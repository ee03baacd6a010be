"""Tight hole ahead of a bit that is tripped: where it is, when it is said, and when it is not."""

from __future__ import annotations

import numpy as np
import pytest
from live_wires import WALL, Clock

from helibore import Live, RigidBody
from helibore.live.ahead import APART, Ahead, Place, _joined
from helibore.live.alarms import Alarms
from helibore.live.rules.configuration import parse
from helibore.live.wire import wits

RIG = '[source.rig]\naddress = "host"\nunits = "metric"\nitems = { bit_depth = "0108", hole_depth = "0110" }\n'
TIGHT = (118.0, 119.0)


class Trip:
    """A hole of 218 mm from 110 to 125 m with a meter of 206 mm, and a bit that moves in it."""

    def __init__(
        self, alarms: str = "tight = 0.006\n", samples: int = 9000, more: str = "", gap: tuple[float, float] = (0, 0)
    ) -> None:
        self.clock = Clock()
        self.live = Live(parse(f"{WALL}[alarms]\n{alarms}{RIG}{more}"), clock=self.clock)
        draw = np.random.default_rng(4)
        depth = np.sort(draw.uniform(110, 125, samples))
        depth = depth[(depth < gap[0]) | (depth > gap[1])]
        radius = 0.109 - 0.006 * ((depth > TIGHT[0]) & (depth < TIGHT[1]))
        self.live.append_samples(depth, draw.uniform(0, 360, depth.size), radius)
        self.alarms = Alarms(self.live, {"rig": "connected"})

    def to(self, bit: float, hole: float = 130.0) -> None:
        self.clock.step(5)
        self.live.receive("rig", wits.frame([(108, f"{bit:.2f}"), (110, f"{hole:.2f}")]))
        self.alarms.ahead._due = 0.0  # as if the last look had been long ago
        self.alarms.check()

    @property
    def said(self) -> list[str]:
        return [one.text for one in self.alarms.active if one.rule == "tight_ahead"]


def test_pulling_out_says_what_lies_above_the_bit():
    trip = Trip()
    trip.to(130.0)
    trip.to(129.7)
    assert trip.said == []  # it has hardly moved
    trip.to(127.0)
    (text,) = trip.said
    assert text.startswith("tight hole above the bit at 127.0 m: from 118.0 to 119.0 m 206.0 mm pass at most, the bit")
    found = trip.alarms.ahead.found
    assert found is not None
    assert (found.body, [of.tightest > 118 for of in found.places]) == ("bit", [True])
    assert found.sticks_at == pytest.approx(TIGHT[1] + 0.3, abs=0.15)  # then the upper end of the body is there
    assert (found.top, found.bottom) == pytest.approx(TIGHT, abs=0.15)
    assert found.diameter == pytest.approx(0.206, abs=0.0005)
    trip.to(121.0)
    assert trip.said == [text]  # the alarm is the same
    assert trip.alarms.ahead.found.sticks_at == pytest.approx(TIGHT[1] + 0.3, abs=0.15)
    for bit in (119.2, 118.8, 118.4):  # the string is in it
        trip.to(bit)
        assert trip.said == [text]
    trip.to(117.0)
    assert trip.said == []


def test_running_in_says_what_lies_below_the_bit():
    trip = Trip()
    for bit in (112.0, 114.0):
        trip.to(bit)
    assert trip.said[0].startswith("tight hole below the bit at 114.0 m")
    assert trip.alarms.ahead.found.sticks_at == pytest.approx(TIGHT[0], abs=0.15)
    trip.to(118.5)
    assert trip.alarms.ahead.found.sticks_at == pytest.approx(118.5, abs=0.15)  # where it is


@pytest.mark.parametrize(
    ("alarms", "path"),
    [
        ("tight = 0.006\nahead = 5.0\n", (130.0, 127.0)),
        ("tight = 0.02\n", (130.0, 127.0)),
        ("washout = 0.02\n", (130.0, 127.0)),
        ("tight = 0.006\n", (112.0, 110.0)),
    ],
    ids=["too far", "not so tight", "no limit", "behind the bit"],
)
def test_no_alarm(alarms, path):
    trip = Trip(alarms)
    for bit in path:
        trip.to(bit)
    assert trip.said == []
    assert trip.alarms.ahead.found is None


def test_a_body_sticks_where_it_touches_and_not_where_the_limit_is_reached():
    """The hole narrows over a metre: a body of 214 mm touches at 214 mm, far above the 210 mm of the limit."""
    trip = Trip("tight = 0.006\nbody = 0.3\n", more='[[string]]\ndiameter = "214mm"\nlength = 0.3\n')
    draw = np.random.default_rng(6)
    depth = np.sort(draw.uniform(111, 112, 1800))
    trip.clock.step(60)
    trip.live.append_samples(depth, draw.uniform(0, 360, 1800), 0.109 - 0.008 * (112 - depth))
    for bit in (117.0, 115.0):
        trip.to(bit)
    found = trip.alarms.ahead.found
    assert found.sticks_at == pytest.approx(112 - 2 / 8 + 0.3, abs=0.15)
    assert found.places[0].tightest < found.sticks_at - 0.4


def test_on_bottom_the_way_out_is_known_and_no_alarm():
    trip = Trip()
    trip.to(126.0, hole=126.1)
    found = trip.alarms.ahead.found
    assert (found.above, trip.alarms.ahead.outlook.moving, trip.said) == (True, "", [])
    assert (found.top, found.bottom) == pytest.approx(TIGHT, abs=0.15)
    trip.to(125.0, hole=126.1)  # picked up
    trip.to(124.4, hole=126.1)
    assert trip.alarms.ahead.outlook.moving == "up"
    assert trip.said


def test_on_bottom_nothing_is_ahead():
    trip = Trip()
    for bit in (116.0, 114.0):
        trip.to(bit, hole=140.0)
    trip.to(117.1, hole=140.0)
    assert trip.said
    trip.to(130.0, hole=130.1)
    assert trip.said == []


def test_a_long_body_is_stopped_earlier():
    """A collar of 3 m behind the bit reaches the tight meter while the bit is below it."""
    trip = Trip("tight = 0.006\nbody = 3.0\n")
    for bit in (124.0, 121.9):
        trip.to(bit)
    assert trip.alarms.ahead.found is not None
    assert trip.alarms.ahead.found.sticks_at == pytest.approx(TIGHT[1] + 3.0, abs=0.15)
    trip.to(117.8)
    assert trip.said == []


STRING = """
[[string]]
diameter = "190mm"
length = 0.3
[[string]]
name = "stabiliser"
diameter = "212mm"
length = 1.0
position = 6.0
[[string]]
name = "collar"
diameter = 0.17
length = 60.0
position = 7.0
"""


def test_the_string_says_which_of_its_bodies_sticks_and_when():
    """The bit passes; the stabiliser above it does not, by 6 mm. The string reaches above the hole that is known."""
    trip = Trip(more=STRING)
    for bit in (129.5, 128.4):
        trip.to(bit)
    found = trip.alarms.ahead.found
    assert found is not None
    assert (found.above, found.body, found.needed, len(found.places)) == (True, "stabiliser", 0.212, 1)
    assert found.diameter == pytest.approx(0.206, abs=0.0005)
    assert (found.top, found.bottom) == pytest.approx(TIGHT, abs=0.2)
    assert found.sticks_at == pytest.approx(TIGHT[1] + 7, abs=0.15)
    trip.to(123.9)  # all of the stabiliser is above the tight meter
    assert trip.said == []


def test_a_long_string_bends_with_the_hole_where_it_builds():
    """Two bodies 13 m apart in a hole that builds a degree in 3 m: on one axis, neither would have room."""
    survey = 'survey = { depth = "0708", inclination = "0713", azimuth = "0715" }\n'
    ends = "".join(f'[[string]]\ndiameter = "212mm"\nlength = 1.0\nposition = {at}\n' for at in (0.0, 13.0))
    trip = Trip("tight = 0.006\nahead = 3.0\n", more=survey + ends)
    for depth, inclination in ((40.0, 0.0), (150.0, 37.0)):
        items = [(708, f"{depth}"), (713, f"{inclination}"), (715, "0.0")]
        trip.live.receive("rig", wits.frame(items))
    for bit in (124.5, 124.0):
        trip.to(bit)
    assert trip.live.model.stations.reaching(125.0) is not None
    assert trip.alarms.ahead.outlook.moving == "up"
    assert trip.alarms.ahead.outlook.up is None


def test_a_bit_that_hangs_may_move_either_way_and_its_alarm_stays():
    trip = Trip()
    for bit in (130.0, 129.0, 128.0):
        trip.to(bit)
    (said,) = trip.said
    assert trip.alarms.ahead.outlook.moving == "up"
    trip.clock.step(20)
    trip.alarms.check()
    assert trip.alarms.ahead.outlook.moving == "up", "no bit depth has come: nobody knows that it hangs"
    for _ in range(3):
        trip.to(128.0)
    assert trip.alarms.ahead.outlook.moving == ""
    assert trip.said == [said]
    trip.to(127.9)
    assert trip.alarms.ahead.outlook.moving == "up"


def test_the_minutes_in_which_bit_depths_come_and_do_not_change_are_counted():
    trip = Trip()
    trip.to(140.0)  # on bottom, or the depth is stuck: nothing that is sent says which
    for _ in range(61 // 5):
        trip.to(140.0)
    assert trip.alarms.ahead.outlook.same == 1
    trip.clock.step(300)
    trip.alarms.check()
    assert trip.alarms.ahead.outlook.same == 1, "nothing comes: nobody knows whether it changes"
    trip.to(140.0)
    assert trip.alarms.ahead.outlook.same == 6
    trip.to(140.01)
    assert trip.alarms.ahead.outlook.same == 0


@pytest.mark.parametrize("speed", [0.1, 0.5])
def test_a_string_that_moves_slowly_is_not_at_rest(speed):
    """Metres a minute, as when a string is washed down or backreamed."""
    trip, seen = Trip(), set()
    for bit in (126.0, 125.0, 124.0):
        trip.to(bit)
    for step in range(1, 61):
        trip.to(124.0 - speed * step / 12)
        outlook = trip.alarms.ahead.outlook
        seen |= {(outlook.moving, outlook.hangs)} if step > 24 else set()
    assert seen == {("up", False)}
    for _ in range(20):
        trip.to(124.0 - 5 * speed)
    outlook = trip.alarms.ahead.outlook
    assert (outlook.moving, outlook.hangs) == ("", True)


@pytest.mark.parametrize("stop", [125.13, 125.16, 125.18, 125.25])
def test_tight_hole_beside_the_last_turn_is_found_though_the_tool_stopped_within_this_turn(stop):
    trip = Trip()
    depth = np.arange(125.0, stop, 0.0005)
    trip.clock.step(60)
    trip.live.append_samples(depth, depth * 9000 % 360, np.where(depth > stop - 0.08, 0.099, 0.109))
    assert len(trip.live.wall) % trip.live.wall.settings.sectors
    for bit in (130.0, 129.0, 128.0):
        trip.to(bit)
    tight = trip.alarms.ahead.outlook.up.places[0]
    assert tight.top > 124.8
    assert tight.passes < 0.202


def test_nobody_is_sure_of_tight_hole_while_a_sensor_is_off_but_of_that_of_the_others_while_one_is_stuck():
    trip = Trip()
    wrong = trip.live.model.watch.active
    for rules, known in (((), True), (("sensors",), False), (("sensors", "stays"), True)):
        wrong.update({(rule, "mwd"): rule for rule in rules})
        for bit in (122.0, 121.0):
            trip.to(bit)
        (place,) = trip.alarms.ahead.outlook.up.places
        assert (place.sure is not None, place.within is not None) == (known, known)
        assert place.passes == pytest.approx(0.206, abs=0.0005)


def noisy(trip: Trip, diameter: float, noise: float = 0.0) -> None:
    """Scan the hole from 114 to 116 m again, a minute after all that came before."""
    trip.clock.step(60)
    draw = np.random.default_rng(9)
    depth = np.sort(draw.uniform(114, 116, 1200))
    radius = diameter / 2 + draw.normal(0, noise, depth.size) if noise else np.full(depth.size, diameter / 2)
    trip.live.append_samples(depth, draw.uniform(0, 360, depth.size), radius)


def test_reamed_hole_is_as_tight_as_the_last_scan_of_it():
    trip = Trip()
    noisy(trip, 0.206)
    for bit in (122.0, 121.0):
        trip.to(bit)
    assert len(trip.alarms.ahead.outlook.up.places) == 2
    noisy(trip, 0.217)
    trip.to(120.9)
    assert len(trip.alarms.ahead.outlook.up.places) == 1


def test_the_string_is_not_said_to_stick_later_than_it_does():
    """Ledges that lie differently between turns of 0.1 m; a string begins to stick between two of them."""
    late = []
    for by in np.arange(0.0, 0.1, 0.02):
        trip = Trip.__new__(Trip)
        trip.clock = Clock()
        trip.live = Live(parse(f"{WALL}[alarms]\ntight = 0.006\n{RIG}"), clock=trip.clock)
        depth = np.arange(110.0, 125.0, 0.001)
        radius = np.where((depth > 116 + by) & (depth < 118 + by), 0.103, 0.109)
        trip.live.append_samples(depth, depth * 13000 % 360, radius)
        trip.alarms = Alarms(trip.live, {"rig": "connected"})
        for bit in (124.0, 123.0):
            trip.to(bit)
        late.append(118 + by + 0.3 - trip.alarms.ahead.outlook.bodies[0][0])
        for bit in (111.0, 112.0):
            trip.to(bit)
        late.append(trip.alarms.ahead.outlook.bodies[0][1] - 116 - by)
    assert -0.1 <= min(late) <= max(late) < 0.02


@pytest.mark.parametrize("layers", ["", '[layers]\nream = ["ream"]\n'], ids=["no layer takes it", "its own layer"])
def test_what_a_reaming_pass_saw_is_named_though_the_wall_does_not_take_it(layers):
    caliper = '[source.mwd]\naddress = "host"\nunits = "metric"\n'
    caliper += 'caliper = { toolface = ["5010"], radius = ["5012"], offset = 4.0 }\n'
    rig = RIG.replace("items = {", 'items = { activity = "0107",')
    trip = Trip.__new__(Trip)
    trip.clock = Clock()
    trip.live = Live(parse(f"{WALL}[alarms]\ntight = 0.006\n{rig}{layers}{caliper}"), clock=trip.clock)
    trip.alarms = Alarms(trip.live, {"rig": "connected", "mwd": "connected"})
    for row in range(4000):
        drills, at = row < 2500, row % 2500
        bit = 110.0 + 0.008 * at if drills else 130.0 - 0.008 * at
        size = 103.0 if not drills and 119 < bit - 4 < 121 else 109.0
        trip.clock.step(0.5)
        hole, activity = (bit, 2) if drills else (130.0, 4)
        trip.live.receive("rig", wits.frame([(107, str(activity)), (108, f"{bit:.3f}"), (110, f"{hole:.3f}")]))
        trip.live.receive("mwd", wits.frame([(5010, f"{row * 37 % 360}"), (5012, f"{size + row % 97 / 1000:.3f}")]))
    wall = trip.live.wall
    assert wall.radius[(wall.depth > 119.5) & (wall.depth < 120.5)].min() > 0.1085
    for bit in (127.0, 126.0):
        trip.to(bit)
    (place,) = trip.alarms.ahead.outlook.up.places
    assert place[:3] == pytest.approx((119, 121, 0.206), abs=0.2)
    assert place.passes == pytest.approx(0.206, abs=3e-4)


def test_hole_that_is_two_millimetres_too_narrow_for_the_bit_is_named():
    """By less than the limit of the alarm, and in a wall that does not keep what its uncertainty follows from."""
    trip = Trip()
    noisy(trip, 0.214)
    for bit in (117.5, 117.0):
        trip.to(bit)
    (place,) = trip.alarms.ahead.outlook.up.places
    assert place[:2] == pytest.approx((114, 116), abs=0.2)
    assert place.passes == pytest.approx(0.214, abs=2e-4)
    assert place.sure > 0.8
    assert trip.said == []


def test_a_place_says_how_sure_it_is_that_the_bit_is_too_thick_for_it():
    """Less than the bit by less than the limit, by radii of which each may be 4 mm off, and by some of no noise."""
    trip = Trip("tight = 0.012\n", more="")
    noisy(trip, 0.212, 0.004)
    for bit in (117.5, 117.0):
        trip.to(bit)
    assert trip.alarms.ahead.found is None, "by less than the limit of the alarm"
    (place,) = trip.alarms.ahead.outlook.up.places
    assert place.top < place.bottom < 116.2
    assert place.bottom < place.sticks_at < place.bottom + 1.0, "where the upper end of the bit is there"
    assert 0.5 < place.sure < 0.99
    assert 0.002 < place.within < 0.01
    (below,) = trip.alarms.ahead.outlook.down.places
    assert (below.sure, below.at_most) == (1.0, False)


def test_a_bit_that_heaves_hangs_until_it_has_left_the_place():
    """A metre up and down in ten seconds, above hole that is tight; the second way would have been said each time."""
    trip = Trip()
    for bit in (112.0, 113.0):
        trip.to(bit)
    (said,) = trip.said
    moving = set()
    for _ in range(6):
        for bit in (115.0, 113.0):
            trip.to(bit)
            moving.add(trip.alarms.ahead.outlook.moving)
            assert trip.said == [said], "the alarm is that of the way it took before"
    assert moving == {"down", ""}
    assert trip.alarms.ahead.outlook.moving == ""
    trip.to(112.5)
    assert trip.alarms.ahead.outlook.moving == "", "two metres and a half from where it turned round"
    trip.to(110.0)
    assert trip.alarms.ahead.outlook.moving == "up", "five, and it is tripped"
    assert trip.said == []
    trip.to(110.5)
    assert trip.alarms.ahead.outlook.moving == ""
    for step in range(1, 8):
        trip.to(110.5 + 0.1 * step)
    assert trip.alarms.ahead.outlook.moving == "down", "slowly on for half a minute"


def test_the_worst_of_several_tight_places_is_named_beside_the_nearest():
    trip = Trip()
    draw = np.random.default_rng(5)
    depth = np.sort(draw.uniform(112, 113, 900))
    trip.clock.step(60)
    trip.live.append_samples(depth, draw.uniform(0, 360, 900), np.full(900, 0.1))
    for bit in (129.5, 127.0):
        trip.to(bit)
    found = trip.alarms.ahead.found
    assert found is not None
    assert (found.top, found.bottom) == pytest.approx(TIGHT, abs=0.15)
    nearest, worst = found.places
    assert nearest[:2] == pytest.approx(TIGHT, abs=0.15)
    assert worst[:2] == pytest.approx((112.0, 113.0), abs=0.15)
    assert worst.passes == pytest.approx(0.2, abs=1e-4)
    assert "127.0 m: from 118" in trip.said[0]


def test_the_stretch_has_the_mask_of_the_wall():
    """What is cut out counts as sampled what the whole wall counts, and has the wall's bits."""
    trip = Trip()
    wall, ahead = trip.live.wall, trip.alarms.ahead
    stretch = ahead._stretch(115.0, 119.5, 0.3)
    assert stretch is not None
    first = round((stretch.start_depth - wall.start_depth) / wall.settings.pitch) * wall.settings.sectors
    part = slice(first, first + len(stretch.radius))
    assert np.array_equal(stretch.radius, wall.radius[part], equal_nan=True)
    assert np.array_equal(stretch.sampled, wall.sampled[part])
    assert np.count_nonzero(stretch.sampled) > 0
    assert stretch.sample_count < wall.sample_count / 2


@pytest.mark.parametrize("samples", [300, 600, 1200])
def test_few_samples_are_enough_to_say_that_a_meter_is_tight(samples):
    """20 to 80 samples a metre: `Wall.drift` knows nothing there, but those samples alone stop the body."""
    trip = Trip(samples=samples)
    wall = trip.live.wall
    assert np.isnan(wall.drift(0.3).diameter).mean() > 0.5
    trip.to(129.5)
    trip.to(127.0)
    (text,) = trip.said
    assert "tight hole" in text
    found = trip.alarms.ahead.found
    assert found is not None
    assert TIGHT[0] - 0.3 < found.top < found.bottom < TIGHT[1] + 0.3
    assert found.diameter > 0.2055  # it is not said to be tighter than it is


@pytest.mark.parametrize("samples", [300, 1200, 9000])
def test_quiet_hole_of_few_samples_is_not_tight(samples):
    trip = Trip(alarms="tight = 0.006\n", samples=samples)
    trip.to(117.0)
    trip.to(113.0)  # above the tight meter
    assert trip.said == []


def test_limits_beyond_all_reason_cost_no_memory_and_raise_nothing():
    trip = Trip(alarms="tight = 0.006\nahead = 1e9\n")
    for bit in (129.5, 127.0):
        trip.to(bit)
    assert "from 118.0 to 119.0 m" in trip.said[0]
    stretch = trip.alarms.ahead._stretch(-1e9, 1e9, 0.3)
    assert stretch is not None
    assert len(stretch.radius) < 2 * len(trip.live.wall)
    wide = Trip(alarms="tight = 0.5\n")
    for bit in (129.5, 127.0):
        wide.to(bit)
    assert wide.said == []


def test_hole_that_no_sensor_saw_is_named_until_the_string_sticks_before_it():
    """From 115 to 117 m nothing was measured, and neither the hole below 125 m nor that above 110 m."""
    gap = Trip(more='[[string]]\ndiameter = "215mm"\nlength = 0.5\nname = "stabiliser"\n', gap=(115.0, 117.0))
    for bit in (114.5, 112.0):
        gap.to(bit)
    up, down = gap.alarms.ahead.outlook.unseen[0]
    assert up[1] == pytest.approx(110.0, abs=0.2), "above the wall"
    assert down == pytest.approx((115.0, 117.0), abs=0.2), "before the tight meter"
    for bit in (117.6, 117.9):  # between both: the body stands where all was seen, the tight meter is next
        gap.to(bit)
    up, down = gap.alarms.ahead.outlook.unseen[0]
    assert (up, down) == (pytest.approx((115.0, 117.0), abs=0.2), None)
    for bit in (116.0, 116.6):  # the body stands in it: its ends are those of the hole not seen, not those of the body
        gap.to(bit)
    assert gap.alarms.ahead.outlook.unseen[0] == (pytest.approx((115.0, 117.0), abs=0.2),) * 2
    for bit in (122.0, 124.0):
        gap.to(bit, hole=124.5)
    assert gap.alarms.ahead.outlook.unseen[0] == (None, None), "the string sticks before it, the hole ends"
    gap.to(126.0, hole=126.0)  # the body stands in hole that the sensor has not reached
    assert gap.alarms.ahead.outlook.unseen[0][0] == pytest.approx((125.0, 126.0), abs=0.2)


@pytest.mark.parametrize(
    ("path", "gap", "ends"),
    [((123.0, 124.0), (0, 0), (125.0, 180.0)), ((113.0, 114.5), (116.5, 124.5), (116.5, 120.5))],
)
def test_hole_not_seen_goes_down_to_the_bottom_or_to_where_it_was_looked_for(path, gap, ends):
    """Bodies enter hole up to 3 m ahead, and 6 m are looked at. The wall ends at 125 m, or goes on below them."""
    trip = Trip("washout = 0.02\nahead = 3.0\n", more='[[string]]\ndiameter = "200mm"\nlength = 0.5\n', gap=gap)
    for bit in path:
        trip.to(bit, hole=180.0)
    assert trip.alarms.ahead.outlook.unseen[0][1] == pytest.approx(ends, abs=0.2)


def test_without_a_limit_a_string_has_that_of_the_zones_and_no_alarm():
    trip = Trip("washout = 0.02\n", more='[[string]]\ndiameter = "215mm"\nlength = 0.5\n')
    for bit in (130.0, 127.0):
        trip.to(bit)
    outlook = trip.alarms.ahead.outlook
    assert outlook.up.places[0][:2] == pytest.approx(TIGHT, abs=0.15)
    assert trip.said == []


def test_noise_of_the_radii_is_no_tight_hole():
    """With 3 mm of noise, a stabiliser of 212.7 mm in a hole of 218 mm sticks where the hole has 210 mm alone."""
    clock, draw = Clock(), np.random.default_rng(8)
    wall = WALL.replace("sectors = 16", "sectors = 64\nsigma = true").replace("0.216", "0.2159")
    string = '[[string]]\ndiameter = "212.7mm"\nlength = 1.0\nname = "stabiliser"\n'
    live = Live(parse(f"{wall}[alarms]\ntight = 0.003\n{RIG}{string}"), clock=clock)
    depth = np.arange(101, 125, 1 / 640)
    radius = 0.109 - 0.004 * ((depth > TIGHT[0]) & (depth < TIGHT[1])) + draw.normal(0, 0.003, depth.size)
    live.append_samples(depth, np.arange(depth.size) * 22.2 % 360, radius)
    alarms = Alarms(live, {"rig": "connected"})
    for bit in (124.5, 124.0):
        clock.step(5)
        live.receive("rig", wits.frame([(108, f"{bit:.2f}"), (110, "130.0")]))
        alarms.check()
    found = alarms.ahead.found
    assert found is not None
    assert len(found.places) == 1
    assert found.sticks_at == pytest.approx(TIGHT[1] + 1.0, abs=0.3)


FULL_GAUGE, UNDERSIZED = (0.2159, 0.2159, 0.2159), (0.2159, 0.2127, 0.2127)


def _pulled(
    tool: str, sizes: tuple[float, ...], hole: float, ring: float = 0.0, noise: float = 0.0005, bias: float = 0.0
) -> Ahead:
    """What is ahead of a bit and two stabilisers that are pulled: 60 m of round hole, narrower from 130 to 131.5 m."""
    clock, draw = Clock(), np.random.default_rng(12)
    depth = np.arange(100.0, 160.0, {"rotating": 1 / 240, "telemetry": 1 / 50, "arms": 1 / 20}[tool])
    toolface = np.arange(depth.size) * {"rotating": 22.1, "telemetry": 106.8, "arms": 0.9}[tool]
    if tool == "arms":
        depth, toolface = np.repeat(depth, 4), (toolface[:, None] + [20, 110, 200, 290]).ravel()
    radius = np.where((depth > 130) & (depth < 131.5), ring or hole, hole) / 2
    wall = WALL.replace("sectors = 16", "sectors = 64\nsigma = true").replace("0.216", "0.2159")
    bodies = zip(("bit", "near-bit stabiliser", "stabiliser"), sizes, (0.3, 1.0, 1.2), (0, 0.9, 9.2), strict=True)
    of = '[[string]]\nname = "{}"\ndiameter = {}\nlength = {}\nposition = {}\n'
    live = Live(parse(f"{wall}[alarms]\nahead = 30\n{RIG}" + "".join(of.format(*one) for one in bodies)), clock=clock)
    live.append_samples(depth, toolface % 360, radius + bias + draw.normal(0, noise, depth.size))
    ahead = Ahead(live)
    for bit in (158.0, 157.7):
        clock.step(1)
        live.receive("rig", wits.frame([(108, f"{bit:.2f}"), (110, "160.0")]))
        ahead._due = 0.0
        ahead.look()
    return ahead


@pytest.mark.parametrize("tool", ["rotating", "telemetry", "arms"])
@pytest.mark.parametrize(
    ("noise", "bias"), [(0.0005, 0.0), (0.0005, -0.0004), (0.002, 0.0)], ids=["quiet", "off all over", "noisy"]
)
def test_hole_of_bit_size_is_tight_for_no_body_as_thick_as_the_bit(tool, noise, bias):
    outlook = _pulled(tool, FULL_GAUGE, 0.2159, noise=noise, bias=bias).outlook
    places = [place for side in (outlook.up, outlook.down) if side for place in side.places]
    assert [place for place in places if not place.sure < 0.95] == [], "in what is off all over, it may stick"
    assert bias or noise > 0.001 or not places


@pytest.mark.parametrize("tool", ["rotating", "telemetry", "arms"])
def test_a_body_that_surely_sticks_is_named_also_where_the_hole_is_tight_by_less_than_the_limit(tool):
    """210.5 mm are 5.4 mm under the bit, less than the limit of 6.35 mm; the stabilisers of 212.7 mm do not pass."""
    ahead = _pulled(tool, UNDERSIZED, 0.2169, ring=0.2105)
    found = ahead.outlook.up
    assert found is not None
    assert (found.places[0].top, found.places[0].bottom) == pytest.approx((130, 131.5), abs=0.25)
    assert found.places[0].first == "stabiliser"
    assert found.sticks_at == pytest.approx(131.5 + 9.2 + 1.2, abs=0.25)
    assert found.places[0].passes == pytest.approx(0.2105, abs=0.002)
    assert all(up is not None for up, _ in ahead.outlook.bodies), "the bit does not pass either"
    assert ahead.found is None, "the alarm has its limit"
    passed = _pulled(tool, UNDERSIZED, 0.2169, ring=0.2147).outlook
    assert [up for up, _ in passed.bodies[1:]] == [None, None], "1.2 mm under the bit, thinner bodies pass"


def test_tight_hole_with_a_hand_of_wide_hole_between_is_one_place():
    string = RigidBody(0.2, 0.3), RigidBody(0.2, 1.0, 4.0)
    place = Place(top=118.0, bottom=119.0, passes=0.196, sticks_at=119.3, first="bit", tightest=118.5, body=0)
    near = place._replace(top=119.1, bottom=119.4, passes=0.19, sticks_at=124.3, first="body 2", tightest=123.0, body=1)
    (one,) = _joined([near, place], string)
    assert (one.top, one.bottom, one.passes, one.body) == (118.0, 119.4, 0.19, 1)
    far = near._replace(top=119.0 + APART + 0.05, bottom=119.6)
    assert len(_joined([far, place], string)) == 2


def test_a_place_has_the_same_ends_and_size_whichever_way_the_string_comes_and_wherever_it_stands():
    """A hole that is tight by 12 mm in its upper half and by 7 mm below; a bit stands in the middle of it."""
    more = (
        '[[string]]\ndiameter = "216mm"\nlength = 0.3\n[[string]]\ndiameter = "212mm"\nlength = 1.0\nposition = 3.0\n'
    )
    trip = Trip(more=more)
    depth = np.arange(118.5, 119.0, 0.001)
    trip.live.append_samples(depth, np.arange(depth.size) * 22.2 % 360, np.full(depth.size, 0.1055))
    for bit in (124.0, 123.0, 118.7):
        trip.to(bit)
        outlook = trip.alarms.ahead.outlook
        found = {of[:3] for side in (outlook.up, outlook.down) if side for of in side.places}
        if bit == 124.0:
            (place,) = found
        assert found == {place}
    assert outlook.up
    assert outlook.down
    assert place[:2] == pytest.approx(TIGHT, abs=0.05)
    assert place[2] == pytest.approx(0.206, abs=0.001)
