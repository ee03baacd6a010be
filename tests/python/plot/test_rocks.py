"""The rock that a text of a mud log names, and that print and page know the same rocks."""

from __future__ import annotations

import pytest

from helibore.base.rocks import PATTERN, rock_of


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("Claystone, dk gry, blky", "claystone"),
        ("Sandstones w/ shale", "sandstone"),
        ("marly LIMESTONE", "limestone"),
        ("Sst", "sandstone"),
        ("no returns", None),
        ("", None),
    ],
)
def test_a_text_has_the_rock_that_it_names_first(text: str, name: str | None) -> None:
    rock = rock_of("Lithology", text)
    assert (rock and rock.name) == name


def test_only_tracks_of_rocks_have_rocks() -> None:
    assert rock_of("Remarks", "limestone in the cuttings") is None


def test_rocks_differ_by_colour_and_by_pattern() -> None:
    names = (
        "sandstone",
        "siltstone",
        "shale",
        "claystone",
        "marl",
        "limestone",
        "dolomite",
        "anhydrite",
        "salt",
        "coal",
        "granite",
    )
    rocks = [rock_of("Litho", name) for name in names]
    assert len({rock.color for rock in rocks if rock}) == len({rock.marks for rock in rocks if rock}) == len(names)
    wide, tall = PATTERN
    for rock in rocks:
        assert rock
        assert all(0 <= x <= wide and 0 <= y <= tall for x0, y0, x1, y1 in rock.marks for x, y in ((x0, y0), (x1, y1)))
