"""DLIS written by dliswriter comes back identical; damaged DLIS is refused."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from golden_texts import Golden
from wall_samples import wall_samples

import helibore as hb
from helibore.files.dlis_records import rows_of
from helibore.files.raw_set import SectorAxis

pytest.importorskip("dlisio")
dliswriter = pytest.importorskip("dliswriter")


def write(path: Path, sectors: int, rows: int = 60, frames: int = 1, stated: bool = True) -> np.ndarray:
    """One logical file; each frame has depth (0.1 in), gamma and a radius image of ``sectors``."""
    image = np.random.default_rng(sectors).normal(108, 2, (rows, sectors)).astype(np.float32)
    image[5, 3] = -999.25
    file = dliswriter.DLISFile()
    logical = file.add_logical_file()
    logical.add_origin("ORIGIN", file_set_number=1, company="C", well_name="W-9")
    step = 360.0 / sectors
    degrees = dliswriter.AttrSetup([sector * step for sector in range(sectors)], units="deg")
    axis = logical.add_axis("AZIMUTH", axis_id="AZIMUTH", coordinates=degrees, spacing=step)
    for number in range(frames):
        depth = logical.add_channel(f"TDEP{number or ''}", data=400_000 + 60.0 * np.arange(rows), units="0.1 in")
        gamma = logical.add_channel(f"GR{number or ''}", data=np.arange(rows, dtype=np.float32) + number, units="gAPI")
        radius = logical.add_channel(
            f"RADI{number or ''}",
            data=image,
            units="mm",
            long_name="radius image",
            **({"axis": axis} if stated else {}),
        )
        logical.add_frame(f"MAIN{number or ''}", channels=(depth, gamma, radius), index_type="BOREHOLE-DEPTH")
    file.write(path, output_chunk_size=2**20)
    return image


@pytest.mark.parametrize("sectors", [36, 128])
def test_images_come_back_identical(tmp_path: Path, sectors: int) -> None:
    image = write(tmp_path / "renamed.las", sectors)
    with hb.open(tmp_path / "renamed.las") as file:
        one = file.set()
        assert (file.format, one.name, one.rows, one.index, one.header["well"]) == ("DLIS", "MAIN", 60, "TDEP", "W-9")
        assert [(c.name, c.unit, c.shape) for c in one] == [
            ("TDEP", "0.1 in", (60,)), ("GR", "gAPI", (60,)), ("RADI", "mm", (60, sectors)),
        ]  # fmt: skip
        assert one["RADI"].values.dtype == np.float32
        assert (one["RADI"].missing, one["RADI"].description) == (1, "radius image")
        expected = image.copy()
        expected[5, 3] = np.nan
        np.testing.assert_array_equal(one["RADI"].values, expected)
        np.testing.assert_array_equal(one["GR"].values, np.arange(60))
        assert one["RADI"].axis == SectorAxis(0.0, 360.0 / sectors, "deg")
        found = wall_samples(file)
        assert found.radius.size == 60 * sectors - 1
        assert found.dropped == {"RADI": 1}
        np.testing.assert_allclose(found.depth[:1], 400_000 * 0.00254)
        view = file.image("RADI")
        np.testing.assert_allclose(view.depth, (400_000 + 60.0 * np.arange(60)) * 0.00254)


def test_a_frame_that_states_far_more_values_than_the_file_can_hold_is_refused(tmp_path: Path, golden: Golden) -> None:
    path = tmp_path / "bomb.dlis"
    file = dliswriter.DLISFile()
    logical = file.add_logical_file()
    logical.add_origin("ORIGIN", file_set_number=1)
    depth = logical.add_channel("TDEP", data=np.arange(4.0), units="m")
    image = logical.add_channel("RADI", data=np.zeros((4, 16_500), np.uint8))
    logical.add_frame("MAIN", channels=(depth, image), index_type="BOREHOLE-DEPTH")
    file.write(path, output_chunk_size=2**20)
    stated, other = ((0xC0000000 | size).to_bytes(4, "big") for size in (16_500, 10**9))
    content = path.read_bytes()
    assert stated in content
    path.write_bytes(content.replace(stated, other))
    with golden.raises():
        hb.open(path)


def test_values_stay_after_close_and_frames_are_sets(tmp_path: Path) -> None:
    write(tmp_path / "w.dlis", 36, frames=2)
    file = hb.open(tmp_path / "w.dlis")
    assert [one.name for one in file.sets] == ["MAIN", "MAIN1"]
    gamma = file.set("MAIN1")["GR1"]
    first = gamma.values[0]
    file.close()
    assert gamma.values[0] == first == 1.0


def test_image_without_a_stated_axis(tmp_path: Path, golden: Golden) -> None:
    write(tmp_path / "w.dlis", 36, stated=False)
    with hb.open(tmp_path / "w.dlis") as file:
        assert (file.image("RADI").first, file.image("RADI").step) == (None, None)
        with golden.raises():
            wall_samples(file)


@pytest.mark.parametrize("last", [270.0, 240.0])
def test_sectors_at_uneven_angles_are_refused(tmp_path: Path, last: float, golden: Golden) -> None:
    file = dliswriter.DLISFile()
    logical = file.add_logical_file()
    logical.add_origin("ORIGIN", file_set_number=1)
    degrees = dliswriter.AttrSetup([0.0, 90.0, 180.0, last], units="deg")
    axis = logical.add_axis("AZIMUTH", axis_id="AZIMUTH", coordinates=degrees)
    depth = logical.add_channel("TDEP", data=np.arange(5.0), units="m")
    radius = logical.add_channel("RADI", data=np.full((5, 4), 108.0), units="mm", axis=axis)
    logical.add_frame("MAIN", channels=(depth, radius), index_type="BOREHOLE-DEPTH")
    file.write(tmp_path / "w.dlis", output_chunk_size=2**20)
    with hb.open(tmp_path / "w.dlis") as opened:
        columns = opened.image("RADI")
        if last == 270.0:
            assert columns.sector_image(origin="edge", reference="north").values.shape == (5, 4)
            return
        with golden.raises():
            columns.sector_image(origin="edge", reference="north")
        with golden.raises():
            wall_samples(opened)


def test_truncated_anywhere_is_refused(tmp_path: Path) -> None:
    write(tmp_path / "w.dlis", 36)
    whole = (tmp_path / "w.dlis").read_bytes()
    cut = tmp_path / "cut.dlis"
    for size in range(90, len(whole), len(whole) // 23):
        cut.write_bytes(whole[:size])
        with pytest.raises(ValueError, match=r"^cut.dlis: "):
            _read_everything(cut)


def _read_everything(path: Path) -> None:
    with hb.open(path) as file:
        for one in file.sets:
            for channel in one:
                _ = channel.values


def test_damage_is_read_or_refused(tmp_path: Path) -> None:
    from test_files_fuzz import damaged, opened_or_refused

    write(tmp_path / "w.dlis", 36, rows=10)
    whole = (tmp_path / "w.dlis").read_bytes()
    spoiled = tmp_path / "spoiled"
    opened = 0
    for seed in range(150):
        spoiled.write_bytes(damaged(whole, seed))
        opened += opened_or_refused(spoiled)
    assert opened > 0


def test_text_that_is_not_utf8_is_reported(tmp_path: Path) -> None:
    write(tmp_path / "w.dlis", 36)
    whole = (tmp_path / "w.dlis").read_bytes()
    assert whole.count(b"radius image") == 1
    (tmp_path / "w.dlis").write_bytes(whole.replace(b"radius image", b"radius imag\xe9"))
    with hb.open(tmp_path / "w.dlis") as file:
        assert file["RADI"].description == "radius imagé"
        assert any("unable to decode" in remark for remark in file.set().remarks)


def test_a_damaged_or_empty_frame_does_not_block_the_others(tmp_path: Path, golden: Golden) -> None:
    write(tmp_path / "w.dlis", 36, frames=2)
    whole = (tmp_path / "w.dlis").read_bytes()
    undescribed = whole.replace(b"\x03GR1", b"\x03GX1", 1)  # the channel's own description; the frame still names GR1
    (tmp_path / "w.dlis").write_bytes(undescribed)
    with hb.open(tmp_path / "w.dlis") as file:
        one = file.set()
        assert (one.name, one.rows) == ("MAIN", 60)
        (text,) = one.remarks
    said = r"another set is left out: w.dlis: frame MAIN1: truncated or damaged \(.*GR1.* not found\)"
    assert re.fullmatch(said, text)

    def without_rows(content: bytes, name: bytes) -> bytes:
        """Let the rows of a frame belong to a frame that is not there."""
        before, description, rows = content.partition(bytes([len(name)]) + name)
        return before + description + rows.replace(description, description[:-1] + b"X")

    (tmp_path / "w.dlis").write_bytes(without_rows(whole, b"MAIN1"))
    with hb.open(tmp_path / "w.dlis") as file:
        assert [(one.name, one.rows) for one in file.sets] == [("MAIN", 60)]
        assert file.set().remarks == ["left out, because they have no rows: MAIN1"]
    (tmp_path / "w.dlis").write_bytes(without_rows(without_rows(whole, b"MAIN1"), b"MAIN"))
    with golden.raises():
        hb.open(tmp_path / "w.dlis")


UVARI = {1: bytes([1]), 2: bytes([0x80, 1]), 4: bytes([0xC0, 0, 0, 1])}
NAME = bytes([1, 0, 1]) + b"F"


@pytest.mark.parametrize("size", UVARI)
def test_rows_of_records_are_counted_by_their_values(size: int) -> None:
    """The layout: frame number, a float, a short text, a long text, a name, a status."""
    row = UVARI[size] + bytes(4) + b"\x02ab" + UVARI[size] + b"c" + NAME + b"\x01"
    assert rows_of([NAME + row], "ifsSoq") == 1
    assert rows_of([NAME + 3 * row, NAME + row], "ifsSoq") == 4
    for cut in range(1, len(row)):
        with pytest.raises(ValueError, match="runs past the end"):
            rows_of([NAME + row, NAME + row + row[:cut]], "ifsSoq")
