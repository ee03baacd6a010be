"""Sector images on walls: every quad against an independent loop, edges, gaps, and error texts."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from golden_texts import Golden
from hypothesis import given, settings
from hypothesis import strategies as st
from locations import SHARED

import helibore as hb
from helibore.images.sector_image import SectorImage


def helix(turns: float = 9, sectors: int = 12, pitch: float = 0.1, start: float = 1000.0, toolface: float = 0.0) -> Any:
    shape = SimpleNamespace(sectors=sectors, pitch=pitch, start_toolface=toolface)
    return SimpleNamespace(settings=shape, start_depth=start, radius=np.full(int(turns * sectors) + 1, 0.1))


def centre(wall: Any, k: int) -> tuple[float, float]:
    """The mean of the four corners, corner by corner, toolface not wrapped."""
    K, s = wall.settings.sectors, wall.settings
    depths = [wall.start_depth + j * s.pitch / K for j in (k, k + 1, k + 1 + K, k + K)]
    return sum(depths) / 4, s.start_toolface + 360 * (k % K + 0.5) / K


def sector_centre(image: SectorImage, sector: int) -> float:
    step = 360 / image.sectors
    along = sector * step + (step / 2 if image.origin == "edge" else 0)
    return image.offset + (along if image.direction == "clockwise" else -along)


def apart(a: float, b: float) -> float:
    return abs((a - b + 180) % 360 - 180)


def cell(image: SectorImage, depth: float, toolface: float) -> float:
    """The nearest row within reach, the nearest sector centre: by search, not by formula."""
    row = min(range(len(image.depth)), key=lambda i: abs(image.depth[i] - depth))
    if abs(image.depth[row] - depth) > image.reach:
        return math.nan
    return float(image.values[row, min(range(image.sectors), key=lambda s: apart(sector_centre(image, s), toolface))])


def linear(image: SectorImage, depth: float, toolface: float) -> float:
    """Hat functions over every cell; a missing cell with a say, or rows too far apart, leave nothing."""
    above, below = np.flatnonzero(image.depth <= depth), np.flatnonzero(image.depth > depth)
    if not above.size or not below.size:
        return math.nan
    a, b = above[-1], below[0]
    spacing = image.depth[b] - image.depth[a]
    if spacing > 2 * image.reach:
        return math.nan
    total = 0.0
    for row in (a, b):
        for sector in range(image.sectors):
            say = (1 - abs(image.depth[row] - depth) / spacing) * max(
                0.0, 1 - apart(sector_centre(image, sector), toolface) / (360 / image.sectors)
            )
            if say > 1e-12:
                total += say * image.values[row, sector]
    return total


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 2**31),
    sectors=st.integers(2, 20),
    origin=st.sampled_from(["centre", "edge"]),
    direction=st.sampled_from(["clockwise", "counterclockwise"]),
    offset=st.floats(-400, 400).map(lambda x: round(x, 2) + 0.00137),  # no quad's centre on a border
    pitch=st.sampled_from([0.1, -0.1, 0.037]),
    method=st.sampled_from(["cell", "linear"]),
)
def test_every_quad_equals_an_independent_loop(
    seed: int, sectors: int, origin: Any, direction: Any, offset: float, pitch: float, method: Any
) -> None:
    random = np.random.default_rng(seed)
    wall = helix(pitch=pitch, toolface=float(random.uniform(0, 360)))
    depth = 1000 + np.sign(pitch) * np.cumsum(random.choice([0.03, 0.05, 0.3], 14) + random.uniform(0, 0.01, 14))
    values = random.normal(size=(14, sectors))
    values[random.random(values.shape) < 0.1] = np.nan
    image = SectorImage(
        depth, values, "GR", origin=origin, reference="north", direction=direction, offset=offset, reach=0.05
    )
    on = image.on(wall, method)
    assert on.shape == (wall.radius.size - wall.settings.sectors - 1,)
    expected = [(cell if method == "cell" else linear)(image, *centre(wall, k)) for k in range(on.size)]
    np.testing.assert_allclose(on, expected, rtol=0, atol=1e-9)


@pytest.mark.parametrize(("origin", "first"), [("edge", [0, 0, 1, 1]), ("centre", [0, 1, 1, 2])])
def test_the_origin_turns_the_image_by_half_a_sector(origin: Any, first: list[int]) -> None:
    wall = helix(sectors=8, turns=3)
    image = SectorImage([1000, 1000.3], [[0, 1, 2, 3]] * 2, "GR", origin=origin, reference="high-side")
    assert image.on(wall)[:4].tolist() == first


def test_rows_may_come_in_any_order_and_an_absent_row_is_a_gap() -> None:
    wall = helix(turns=21)
    depth = np.array([1002.0, 1001.0, 1000.0, 1001.5, 1000.5])
    image = SectorImage(depth, np.tile(depth[:, None], 4), "Z", origin="edge", reference="north")
    again = SectorImage(depth[::-1], np.tile(depth[::-1, None], 4), "Z", origin="edge", reference="north")
    assert image.on(wall).tobytes() == again.on(wall).tobytes()
    assert not np.isnan(image.on(wall)).any()
    keep = depth != 1001.0
    gapped = SectorImage(depth[keep], np.tile(depth[keep, None], 4), "Z", origin="edge", reference="north")
    centres = np.array([centre(wall, k)[0] for k in range(gapped.on(wall).size)])
    np.testing.assert_array_equal(np.isnan(gapped.on(wall)), (centres >= 1000.875) & (centres < 1001.125))


def test_a_real_wall_takes_the_values_gaps_or_not() -> None:
    depth = np.r_[np.arange(0, 5, 0.01), np.arange(9, 12, 0.01)]
    caliper = hb.Caliper(depth, np.arange(depth.size) * 37.0 % 360, np.full(depth.size, 0.11))
    wall = hb.reconstruct(caliper, bit_diameter=0.216, sectors=16)
    rows = np.arange(-0.5, 13, 0.25)
    image = hb.SectorImage(rows, np.random.default_rng(1).normal(size=(rows.size, 8)), "GR", "gAPI", origin="edge",
                           reference="high-side")  # fmt: skip
    surface = wall.surface()
    surface.attributes["GR"] = image.on(wall)
    assert 0 < len(surface.quads) < image.on(wall).size
    for quad in range(0, len(surface.quads), 7):
        where = centre(wall, int(surface.quad_index[quad]))
        assert surface.attributes["GR"][quad] == cell(image, where[0] + 1e-9, where[1])


def test_the_images_of_a_real_memory_file_lie_where_its_cells_are() -> None:
    """P11-A-02: 16-sector density and 8-sector gamma, every quad. Where sector 1 lies is assumed: files do not say."""
    path = SHARED / "lwd-images/P11-A-02_Composite_MEM_Image_NF.las"
    if not path.exists():
        pytest.skip(f"shared/data/lwd-images/{path.name} is not beside the project")
    pytest.importorskip("lasio")
    file = hb.open(path)
    for name, sectors in (("ABDC", 16), ("GRAS", 8)):
        columns = file.image(name)
        image = SectorImage(
            columns.depth, columns.values, name, columns.unit, origin="edge", reference="high-side", offset=1.0
        )
        assert image.sectors == sectors
        assert image.missing == np.isnan(columns.values).sum()
        there = image.depth[~np.isnan(image.values).all(axis=1)]
        wall = helix(turns=120, sectors=64, start=float(np.median(there)) + 0.00311)
        on = image.on(wall)
        assert np.isfinite(on).any()
        rows = columns.depth
        for k in range(on.size):
            depth, toolface = centre(wall, k)
            row = int(np.argmin(np.abs(rows - depth)))
            within = abs(rows[row] - depth) <= image.reach
            expected = columns.values[row, int((toolface - 1) % 360 // (360 / sectors))] if within else math.nan
            np.testing.assert_equal(on[k], expected)


def test_an_image_is_frozen_counted_and_says_what_it_is(golden: Golden) -> None:
    values = np.array([[1.0, np.nan, 3.0], [4.0, 5.0, 6.0]])
    image = SectorImage([2, 1], values, "GR", "gAPI", origin="centre", reference="north", offset=10)
    values[:] = 0
    assert image.values[0].tolist() == [4, 5, 6]
    assert not image.values.flags.writeable
    golden(repr(image))


BUILD = hb.Survey([1000.0, 1002.0, 1010.0], [0.0, 0.0, 60.0], [70.0, 70.0, 95.0])


def seen_from(path: hb.Path, depth: float, toolface: float, pole: tuple[float, float, float]) -> float:
    """The angle from a pole to a point of the wall, by vectors: the pole less its part along the hole is at 0."""
    ahead, right, tangent = path.frame(depth)
    point = math.cos(math.radians(toolface)) * ahead + math.sin(math.radians(toolface)) * right
    zero = np.array(pole) - np.dot(pole, tangent) * tangent
    return math.degrees(math.atan2(np.dot(point, np.cross(tangent, zero)), np.dot(point, zero)))


@pytest.mark.parametrize("reference", ["high-side", "north"])
@pytest.mark.parametrize("wanted", ["high-side", "north", "parallel-transport"])
@pytest.mark.parametrize("layout", [("edge", "clockwise"), ("centre", "counterclockwise")])
def test_an_image_is_turned_into_the_reference_of_the_path(
    reference: Any, wanted: Any, layout: tuple[Any, Any]
) -> None:
    path = BUILD.path(reference=wanted)
    depth = np.arange(1000.05, 1011.0, 0.1)
    values = np.random.default_rng(3).random((depth.size, 8))
    image = SectorImage(depth, values, "GR", origin=layout[0], direction=layout[1], reference=reference, offset=17.0)
    wall = hb.Wall(bit_diameter=0.2, sectors=12, start_depth=1000.0, stop_depth=1011.0)
    wall.append([1000.0, 1011.0], [0.0, 0.0], [0.1, 0.1])
    plain = image.on(wall)
    wall.path = path
    turned = image.on(wall)
    if wanted == reference:
        assert np.array_equal(turned, plain, equal_nan=True)
        return
    pole, checked = ((0.0, 0.0, -1.0), (1.0, 0.0, 0.0))[reference == "north"], 0
    for k in range(0, turned.size, 7):
        at, toolface = centre(wall, k)
        row = int(np.argmin(np.abs(depth - at)))
        if depth[row] > 1010.0 or ("high-side" in (reference, wanted) and depth[row] <= 1002.0):
            assert math.isnan(turned[k])  # beyond the path, or without a high side
            continue
        angle = seen_from(path, depth[row], toolface, pole)
        if min(apart(angle, border) for border in 17.0 + 45 * np.arange(8) + 22.5 * (layout[0] == "centre")) < 0.5:
            continue
        assert turned[k] == cell(image, at, angle)
        checked += 1
    assert checked > 100
    wall.images["GR"] = image
    surface = wall.surface(start=1003.0, stop=1009.0)
    assert np.array_equal(surface.attributes["GR"], turned[surface.quad_index], equal_nan=True)


def test_a_turned_image_is_linear_between_the_centres_of_its_own_cells() -> None:
    path = hb.Survey([1000.0, 1010.0], [48.0, 48.0], [248.0, 248.0]).path()  # the high side lies at 254.87 from north
    depth = np.arange(1000.0, 1010.0, 0.1)
    slope = np.tile(np.abs(np.arange(36) * 10.0 - 180.0), (depth.size, 1))
    image = SectorImage(depth, slope, "GR", origin="centre", reference="north")
    turned = image.onto(path, "linear")
    north = (turned.toolface + 254.87) % 360
    np.testing.assert_allclose(turned.values[50], np.abs((north) - 180.0), atol=0.1)
    assert (turned.reference, turned.reach, turned.sectors) == ("high-side", image.reach, 360)


def test_an_image_that_cannot_be_turned_says_so(golden: Golden) -> None:
    image = SectorImage([1, 2], [[1, 2], [3, 4]], "GR", origin="edge", reference="north")
    with golden.raises():
        image.onto(BUILD.path(reference="parallel-transport"))
    carried = SectorImage([1000, 1001], [[1, 2], [3, 4]], "GR", origin="edge", reference="parallel-transport")
    with golden.raises():
        carried.onto(BUILD.path())


def test_a_wall_without_quads_takes_no_values() -> None:
    image = SectorImage([1, 2], [[1, 2], [3, 4]], "GR", origin="edge", reference="north")
    assert image.on(hb.Wall(bit_diameter=0.2)).shape == (0,)


@pytest.mark.parametrize(
    "changed",
    [
        {"origin": "center"},
        {"reference": "top"},
        {"direction": "left"},
        {"offset": math.nan},
        {"depth": [1, math.nan]},
        {"depth": [3, 3]},
        {"depth": []},
        {"depth": [1]},
        {"values": [[1, 2], [3, math.inf]]},
        {"values": np.full((2, 2), np.nan)},
        {"depth": [1], "values": [[1, 2]]},
        {"reach": 0},
    ],
)
def test_bad_input_is_named(changed: dict[str, Any], golden: Golden) -> None:
    given = {"depth": [1, 2], "values": [[1, 2], [3, 4]], "name": "GR", "origin": "edge", "reference": "north"}
    with pytest.raises(ValueError) as error:  # noqa: PT011
        SectorImage(**{**given, **changed})
    golden(str(error.value))


def test_an_image_elsewhere_and_an_unknown_method_are_refused(golden: Golden) -> None:
    image = SectorImage([1, 2], [[1, 2], [3, 4]], "GR", origin="edge", reference="north")
    with golden.raises():
        image.on(helix())
    with golden.raises():
        image.on(helix(start=1.0), "cubic")  # type: ignore[arg-type]


def test_an_image_must_say_where_sector_1_lies() -> None:
    with pytest.raises(TypeError, match="origin"):
        SectorImage([1, 2], [[1, 2], [3, 4]], "GR", reference="north")  # type: ignore[call-arg]
