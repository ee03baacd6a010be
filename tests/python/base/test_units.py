"""The table of units, and the texts that carry them."""

from __future__ import annotations

import math

import pytest
from golden_texts import Golden
from hypothesis import given
from hypothesis import strategies as st

from helibore.base import units


@pytest.mark.parametrize(
    ("unit", "kind", "factor"),
    [
        ("M", "length", 1.0),
        ("FT", "length", 0.3048),
        ("F", "length", 0.3048),
        ("ftUS", "length", 0.3048006096012192),
        ("IN", "length", 0.0254),
        ("INCHES", "length", 0.0254),
        ("MM", "length", 0.001),
        ("cm", "length", 0.01),
        ("0.1 in", "length", 0.00254),
        (".1IN", "length", 0.00254),
        ("DEG", "angle", 1.0),
        ("DEGA", "angle", 1.0),
        ("°", "angle", 1.0),
        ("RAD", "angle", 180 / math.pi),
        ("S", "time", 1.0),
        ("ms", "time", 0.001),
    ],
)
def test_factor(unit: str, kind: str, factor: float) -> None:
    assert units.factor(unit, kind) == pytest.approx(factor, rel=1e-15)


@pytest.mark.parametrize(
    ("name", "kind", "stem", "unit"),
    [
        ("md_m", "length", "md", "m"),
        ("tdep_0.1in", "length", "tdep", "0.1in"),
        ("tdep_0.1_in", "length", "tdep", "0.1in"),
        ("pass_1_m", "length", "pass_1", "m"),
        ("pfc1_x_in", "length", "pfc1_x", "in"),
        ("Depth (ft)", "length", "Depth", "ft"),
        ("CAL[mm]", "length", "CAL", "mm"),
        ("rb_deg", "angle", "rb", "deg"),
        ("rb_deg", "length", "rb_deg", None),
        ("MD", "length", "MD", None),
        ("m", "length", "m", None),
        ("_m", "length", "_m", None),
        ("GRAS[1]", "length", "GRAS[1]", None),
        ("depth_of_m_x", "length", "depth_of_m_x", None),
    ],
)
def test_split(name: str, kind: str, stem: str, unit: str | None) -> None:
    assert units.split(name, kind) == (stem, unit)


@pytest.mark.parametrize(
    ("text", "metres"),
    [
        ("8.5in", 0.2159),
        (" 8.5 IN ", 0.2159),
        ("8 1/2in", 0.2159),
        ("12-1/4 in", 0.31115),
        ("1/16in", 0.0015875),
        ("-3/4 in", -0.01905),
        ("0.216m", 0.216),
        ("0.216", 0.216),
        ("100mm", 0.1),
        (".5ft", 0.1524),
        ("2e3mm", 2.0),
        ("-5m", -5.0),
        ("10 0.1in", 0.0254),
    ],
)
def test_quantity(text: str, metres: float) -> None:
    assert units.quantity(text, "length") == pytest.approx(metres, rel=1e-15)


@given(value=st.floats(-1e6, 1e6), unit=st.sampled_from(["m", "cm", "mm", "ft", "ftUS", "in"]))
def test_quantity_reads_what_is_written(value: float, unit: str) -> None:
    assert units.quantity(f"{value!r}{unit}", "length") == value * units.factor(unit, "length")


KNOWN = "m, cm, mm, ft, ftUS, in, 0.1in, deg, rad, s, ms, us, min, h, rpm, c/s, rad/s"


@pytest.mark.parametrize(
    "text",
    [
        "8.5 furlong",
        "8.5deg",
        "big",
        "",
        "12,5in",
        "nan",
    ],
)
def test_bad_quantity(text: str, golden: Golden) -> None:
    with pytest.raises(ValueError) as caught:  # noqa: PT011 - the whole text is compared
        units.quantity(text, "length")
    golden(str(caught.value))
