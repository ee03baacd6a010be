"""Depths of the vertices of a helix, against all of them."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from helibore.samples.helix import Helix


@given(
    start=st.floats(-2000, 2000),
    pitch=st.floats(0.001, 2).flatmap(lambda pitch: st.sampled_from([pitch, -pitch])),
    sectors=st.integers(3, 70),
    vertices=st.integers(0, 400),
    data=st.data(),
)
def test_between_is_every_vertex_whose_depth_is_between(
    start: float, pitch: float, sectors: int, vertices: int, data: st.DataObject
) -> None:
    helix = Helix(start, 0.0, pitch, sectors)
    depth = helix.depth(np.arange(vertices))
    ends = st.one_of(st.floats(-3000, 3000), st.sampled_from([start, *depth.tolist()]))
    low, high = data.draw(ends), data.draw(ends)
    expected = np.flatnonzero((depth >= low) & (depth <= high))
    np.testing.assert_array_equal(np.arange(vertices)[helix.between(low, high, vertices)], expected)
