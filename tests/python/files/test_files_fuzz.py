"""Damaged files of every format: opened, or refused with an error that names the file; never anything else.

``python tests/python/files/test_files_fuzz.py SECONDS`` tries new damage for so long, and writes the files that break
the rule to the folder that it prints. With atheris installed coverage leads:
``python tests/python/test_files_fuzz.py atheris -max_total_time=600``. What was found once stands below in ``FOUND``.
"""

from __future__ import annotations

import gzip
import importlib
import inspect
import json
import random
import sys
import tempfile
import time
from collections.abc import Callable
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import helibore as hb
from helibore.channels.roles import guess

pytest.importorskip("pyarrow")
pytest.importorskip("lasio")

CSV = b"# run 1\nmd_m,rb_deg,cal_x_in,cal_y_in,note\n" + b"".join(
    b'%d.5,%d,8.%d,-999.25,"a, b"\n' % (n, n * 37 % 360, n) for n in range(9)
)
LAS2 = (
    b"~V\n VERS. 2.0 :\n WRAP. NO :\n~W\n STRT.M 1 :\n STOP.M 3 :\n STEP.M 1 :\n NULL. -999.25 :\n WELL. W :\n"
    b"~C\n DEPT.M : depth\n GR.GAPI : gamma\n" + b"".join(b" S[%d].IN : s\n" % n for n in range(1, 5)) + b"~A\n"
    b"1 50 8.5 8.5 8.5 8.5\n2 51-999.25 8.5 8.5 8.5\n3 NaN 8.5 8.5 8.5 8.5\n"
)
LAS3 = (
    b"~Version\nVERS. 3.0 :\nDLM. COMMA :\n~Well\nNULL. -999.25 :\n~Log_Definition[1]\nDEPT.M : {F}\n"
    + b"".join(b"R[%d].MM : r {AF8.3;%ddeg}\n" % (n + 1, n * 90) for n in range(4))
    + b"NOTE. : {S}\n~Log_Data[1] | Log_Definition[1]\n"
    b'1,100,101,102,103,"a, b"\n2,100,,102,103,c\n~Inclinometry_Definition\nMD.M :\nINC.DEG :\nAZI.DEG :\n'
    b"~Inclinometry_Data | Inclinometry_Definition\n0,1,2\n30,2,300\n60,3,10\n"
)
JSON = json.dumps(
    [
        {
            "header": {"name": "log", "well": "W"},
            "curves": [
                {"name": "MD", "unit": "m", "valueType": "float", "dimensions": 1},
                {"name": "RADI", "unit": "mm", "valueType": "float", "dimensions": 3},
                {"name": "T", "unit": None, "valueType": "string", "dimensions": 1},
            ],
            "data": [[1.0, [100, 101, None], "a"], [2.0, None, None], [3, [1e2, 1, 2], "b"]],
        }
    ]
).encode()
WITSML = (
    b'<?xml version="1.0" encoding="UTF-8"?><trajectorys xmlns="http://www.witsml.org/schemas/1series"><trajectory>'
    b"<name>T</name>"
    + b"".join(
        b'<trajectoryStation uid="%d"><md uom="m">%d</md><incl uom="rad">0.%d</incl><azi uom="rad">%d</azi>'
        b"</trajectoryStation>" % (n, n * 30, n, n)
        for n in range(6)
    )
    + b"</trajectory></trajectorys>"
)
WITSML_LOG = (
    b'<logs xmlns="http://www.witsml.org/schemas/1series"><log><name>L</name><indexCurve>MD</indexCurve>'
    b"<nullValue>-999.25</nullValue><logCurveInfo><mnemonic>MD</mnemonic><unit>m</unit></logCurveInfo><logData>"
    b"<mnemonicList>MD,RB,C1,C2</mnemonicList><unitList>m,dega,in,in</unitList>"
    b"<data>1,10,8.5,8.6</data><data>2,,8.5,8.6</data><data>3,350,-999.25,8.6</data></logData></log></logs>"
)


def npz() -> bytes:
    stream = BytesIO()
    image = np.arange(12.0).reshape(3, 4)
    np.savez_compressed(stream, depth_m=np.arange(3.0), image=image, angle_deg=np.arange(4) * 90.0)
    return stream.getvalue()


def parquet_bytes() -> bytes:
    import pyarrow as pa
    from pyarrow import parquet

    stream = BytesIO()
    table = pa.table({"md_m": [1.0, 2.0, 3.0], "image": [[1.0, 2.0, 3.0, 4.0]] * 3, "note": ["a", None, "b"]})
    parquet.write_table(table, stream)
    return stream.getvalue()


SEEDS: dict[str, Callable[[], bytes]] = {
    "csv": lambda: CSV,
    "csv.gz": lambda: gzip.compress(CSV, mtime=0),
    "las2": lambda: LAS2,
    "las2 wrapped": lambda: LAS2.replace(b"WRAP. NO", b"WRAP. YES").replace(b"51-9", b"51 -9"),
    "las3": lambda: LAS3,
    "json": lambda: JSON,
    "witsml": lambda: WITSML,
    "witsml log": lambda: WITSML_LOG,
    "npz": npz,
    "parquet": parquet_bytes,
}

# Pieces that formats give a meaning to: put in at random they reach further than random bytes.
PIECES = (
    b"\n", b"\r", b"\0", b"~", b"~A\n", b"~C\n", b",", b";", b"\t", b'"', b"-999.25", b"nan", b"1e999", b"-", b"1_0",
    b"\xff", b"\xc3\xa9", b"\xef\xbb\xbf", b"<", b"</", b"<!DOCTYPE a>", b"&a;", b"[", b"]", b"{", b"}", b"null",
    b"9" * 400, b" ", b"#", b":", b".", b"|", b"(m)", b"\xe2\x82\xac", b"true",
)  # fmt: skip


def damaged(content: bytes, seed: int) -> bytes:
    """The content with one to four wounds: a flipped byte, a cut, a doubled piece, a piece of another meaning."""
    chance = random.Random(seed)
    spoiled = bytearray(content)
    for _ in range(chance.randint(1, 4)):
        at = chance.randrange(len(spoiled) + 1)
        kind = chance.randrange(5)
        if kind == 0 and at < len(spoiled):
            spoiled[at] = chance.randrange(256)
        elif kind == 1:
            del spoiled[at:]
        elif kind == 2:
            del spoiled[at : at + chance.randint(1, 40)]
        elif kind == 3:
            spoiled[at:at] = spoiled[at : at + chance.randint(1, 80)]
        else:
            spoiled[at:at] = chance.choice(PIECES)
    return bytes(spoiled)


STEPS = (
    hb.Preparation(least_radius=0.02, greatest_radius=1.0, repeated=True, spikes=6.0, recentre=True),
    hb.Preparation(closed=0.05, stuck=3, turn_height=0.5, latency=0.1, sensor_offset=1.0, greatest_radius=1.0),
    hb.Preparation(reversal=1.0, find_shifts=True, bias="side", latest=True, least_radius=0.0),
)


def opened_or_refused(path: Path) -> bool:
    """Do all that can be done with a file; True where it opened. Any error but a named ValueError passes through."""
    try:
        with hb.open(path) as file:
            for one in file.sets:
                roles = guess(one)
                for channel in one:
                    assert channel.values.shape == channel.shape
                    if not channel.is_text:
                        assert not np.isinf(channel.values).any()
                for use in (one.readings, one.survey, one.caliper):
                    _named(path, lambda use=use, roles=roles: use(roles))
                for steps in STEPS:
                    _named(path, lambda one=one, roles=roles, steps=steps: hb.prepare(one.readings(roles), steps))
                for role in roles.all("image", "radius-image"):
                    _named(path, lambda one=one, role=role: one.image(role.channel))
    except ValueError as error:
        assert str(error).startswith(path.name), f"an error without the file's name: {error!r}"  # noqa: PT017
        return False
    return True


def _named(path: Path, use: Callable[[], object]) -> None:
    try:
        use()
    except ValueError as error:
        assert str(error).startswith(path.name), f"an error without the file's name: {error!r}"  # noqa: PT017


@pytest.mark.parametrize("name", SEEDS)
def test_the_seeds_open(tmp_path: Path, name: str) -> None:
    (tmp_path / "seed").write_bytes(SEEDS[name]())
    assert opened_or_refused(tmp_path / "seed")


# Each broke the rule once: which seed, and what was put in the place of what.
FOUND = (
    ("parquet", b"note", b"\x8dote"),  # a column name that is not UTF-8
    ("csv", b"-999.25", b"-1"),  # rows without any radius beside one below zero
    ("json", b'"dimensions": 3', b'"dimensions": 33333333333333333333'),  # arrays of more cells than memory
    ("las2", b"VERS. 2.0", b"VERS. inf"),  # a version that is no whole number
)


@pytest.mark.parametrize(("name", "old", "new"), FOUND)
def test_what_was_found_once(tmp_path: Path, name: str, old: bytes, new: bytes) -> None:
    seed = SEEDS[name]()
    assert old in seed
    (tmp_path / "spoiled").write_bytes(seed.replace(old, new))
    opened_or_refused(tmp_path / "spoiled")


@settings(max_examples=600, deadline=None)
@given(name=st.sampled_from(sorted(SEEDS)), seed=st.integers(0, 2**32))
def test_damage_is_read_or_refused(tmp_path_factory: pytest.TempPathFactory, name: str, seed: int) -> None:
    path = tmp_path_factory.getbasetemp() / "spoiled"
    path.write_bytes(damaged(SEEDS[name](), seed))
    opened_or_refused(path)


@settings(max_examples=200, deadline=None)
@given(content=st.binary(max_size=300))
def test_any_bytes(tmp_path_factory: pytest.TempPathFactory, content: bytes) -> None:
    path = tmp_path_factory.getbasetemp() / "any"
    path.write_bytes(content)
    opened_or_refused(path)


@pytest.mark.parametrize("name", SEEDS)
def test_every_truncation(tmp_path: Path, name: str) -> None:
    whole = SEEDS[name]()
    path = tmp_path / "cut"
    for size in range(0, len(whole), 1 + len(whole) // 150):
        path.write_bytes(whole[:size])
        opened_or_refused(path)


def hunt(seconds: float) -> None:
    """Damage files until the time is over; keep and name each one that broke the rule."""
    folder = Path(tempfile.mkdtemp(prefix="helibore-fuzz-"))
    path = folder / "spoiled"
    end, seed, found = time.monotonic() + seconds, random.randrange(2**32), 0
    tries = 0
    while time.monotonic() < end:
        seed, tries = seed + 1, tries + 1
        name = sorted(SEEDS)[seed % len(SEEDS)]
        path.write_bytes(damaged(SEEDS[name](), seed))
        try:
            opened_or_refused(path)
        except Exception as error:
            found += 1
            kept = folder / f"{name.replace(' ', '-')}-{seed}"
            kept.write_bytes(path.read_bytes())
            print(f"{kept}: {type(error).__name__}: {error}")
    print(f"{tries} files, {found} broke the rule")


def led_by_coverage() -> None:
    """Hand the readers to atheris."""
    import atheris

    for name in (
        "files.input_file", "files.raw_set", "files.delimited", "files.number_rows", "files.columnar", "files.las",
        "files.json_log", "files.witsml_log", "channels.sectors", "channels.columns",
    ):  # fmt: skip
        module = importlib.import_module(f"helibore.{name}")
        for owner in (module, *(each for each in vars(module).values() if inspect.isclass(each))):
            for function in vars(owner).values():
                if inspect.isfunction(function) and function.__module__ == module.__name__:
                    atheris.instrument_func(function)
    path = Path(tempfile.mkdtemp(prefix="helibore-fuzz-")) / "spoiled"

    def one(content: bytes) -> None:
        path.write_bytes(content)
        opened_or_refused(path)

    seeds = path.parent / "seeds"
    seeds.mkdir()
    for name, seed in SEEDS.items():
        (seeds / name.replace(" ", "-")).write_bytes(seed())
    atheris.Setup([sys.argv[0], *sys.argv[2:], str(seeds)], one)
    atheris.Fuzz()


if __name__ == "__main__":
    led_by_coverage() if sys.argv[1:2] == ["atheris"] else hunt(float(sys.argv[1]))
