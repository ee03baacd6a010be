"""The stations of a live survey: the path of the batch, however the stations come."""

from __future__ import annotations

import numpy as np
import pytest

import helibore as hb
from helibore.live.model.stations import Stations
from helibore.live.rules.configuration import PathTable
from helibore.live.rules.depth_limits import DepthLimits

SETTINGS = {"method": "minimum-curvature", "reference": "high-side", "head": [1.0, 2.0, 3.0], "extend": 50.0}


@pytest.mark.parametrize("method", ["minimum-curvature", "radius-of-curvature"])
def test_stations_in_any_order_give_the_path_of_the_batch(method):
    draw = np.random.default_rng(5)
    depth = np.arange(60) * 30.0
    inclination, azimuth = 20 + draw.normal(0, 2, 60).cumsum() % 60, draw.uniform(0, 360, 60)
    settings = {**SETTINGS, "method": method}
    stations = Stations(PathTable(**settings), DepthLimits())
    for at in draw.permutation(60).tolist():
        stations.take(depth[at], 5.0, 5.0)  # replaced by the next
        assert stations.take(depth[at], inclination[at], azimuth[at])[1] == ""
        if len(stations) == 1:
            assert stations.survey is None
            assert stations.path is None
        else:
            _ = stations.path
    expected = hb.Survey(depth, inclination, azimuth).path(**{**settings, "head": (1.0, 2.0, 3.0)})
    at = np.linspace(0, 1820, 997)
    assert np.array_equal(stations.path.position(at), expected.position(at))
    assert np.array_equal(stations.path.frame(at), expected.frame(at))
    assert (stations.path.head, stations.path.extend, stations.path.method) == ((1.0, 2.0, 3.0), 50.0, method)
    assert stations.rows().tolist() == np.column_stack([depth, inclination, azimuth]).tolist()
    assert stations.reaching(1800).stop_depth == 1820
    assert stations.reaching(2000).stop_depth == 2000


@pytest.mark.parametrize(
    ("station", "text"),
    [
        ((np.nan, 1.0, 1.0), "station at nan m: depth must be finite"),
        ((20_000.0, 1.0, 1.0), "station at 20000 m: must be in depth_range [0, 15000]"),
        ((60.0, 190.0, 1.0), "station at 60 m: inclination[2] = 190: must lie in 0 to 180 degrees"),
        ((60.0, 1.0, np.nan), "station at 60 m: azimuth[2] = nan: must be finite"),
    ],
)
def test_a_refused_station_changes_nothing(station, text):
    stations = Stations(PathTable(**SETTINGS, stations=[[0.0, 0.0, 0.0], [30.0, 2.0, 40.0]]), DepthLimits())
    path = stations.path
    assert stations.take(*station) == (None, text)
    assert stations.take(30.0, 2.0, 40.0) == (None, "")
    assert stations.path is path


def test_a_wrong_tie_in_is_refused(golden):
    with golden.raises(kind=ValueError):
        Stations(PathTable(**SETTINGS, stations=[[5.0, 200.0, 0.0]]), DepthLimits())
