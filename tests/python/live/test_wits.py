"""The WITS level 0 parser against a slow reader of whole streams, under any chunking, and against bad input."""

from __future__ import annotations

import bisect
import itertools
import math
import re
import threading

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from helibore.live.wire import wits

STRICT = re.compile(rb"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")


PADDING = b" \r\0\x02\x03"
"""What senders put around lines."""


def slow_number(text: bytes, nulls) -> tuple[float, int]:
    text = text.strip(b" ")
    if not text:
        return math.nan, wits.NULL
    if not STRICT.fullmatch(text) or math.isinf(float(text)):
        return math.nan, wits.INVALID
    if float(text) == 0 and re.search(rb"^[^eE]*[1-9]", text):  # smaller than any double
        return math.nan, wits.INVALID
    return (math.nan, wits.NULL) if float(text) in nulls else (float(text), 0)


def slow_read(stream: bytes, nulls=wits.NULLS, line_limit=1024, frame_limit=65536, item_limit=512):
    """(frames of (code, value, flags, raw text), events of (rule, line)) of a stream that ended with a line end."""
    frames, events, lines = [], [], []
    offset = 0
    for ended in stream.split(b"\n")[:-1]:
        line = ended.strip(PADDING) if len(ended) <= line_limit + 1 else ended
        at_end = offset + len(ended)
        if line == b"!!&&":
            lines += [(b"!!", at_end, len(lines) + 1), (b"&&", at_end, len(lines) + 1)]
        else:
            lines.append((line, at_end, len(lines) + 1))
        offset = at_end + 1
    number = 0
    current, begun, body, stray, count = None, 0, 0, False, 0
    numbers = iter(range(1, 10**9))
    for position, (line, at_end, _) in enumerate(lines):
        joined = line == b"&&" and position and lines[position - 1][1] == at_end
        number = number if joined else next(numbers)
        if line == b"&&":
            if isinstance(current, list):
                events.append(("unclosed", begun))
            current, begun, body, stray, count = [], number, at_end + 1, False, 0
        elif line == b"!!":
            if current is None:
                events.append(("stray_end", number))
            elif isinstance(current, list):
                frames.append(current)
            current = None
        elif current is None:
            if line and not stray:
                events.append(("stray_text", number))
                stray = True
        elif isinstance(current, list):
            count += 1
            if at_end - body > frame_limit or count > item_limit:
                events.append(("long_frame" if at_end - body > frame_limit else "many_items", begun))
                current = "dropped"
            elif len(line) > line_limit:
                events.append(("long_line", number))
            elif line and not re.match(rb"(?!00)\d\d(?!00)\d\d", line):
                events.append(("not_an_item", number))
            elif line:
                current.append((int(line[:4]), *slow_number(line[4:], nulls), line[4:]))
    return frames, events


def read(stream: bytes, cuts=(), **limits):
    parser = wits.Parser(**limits)
    frames, events, at, text = [], [], 0, b""
    ends = [place for place, byte in enumerate(stream) if byte == ord("\n")]
    for start, stop in zip([0, *cuts], [*cuts, len(stream)], strict=True):
        batch = parser.feed(stream[start:stop])
        assert batch.base == at
        at += len(batch.text)
        text += batch.text
        for place, frame in enumerate(batch.frames):
            rows = range(frame["first"], frame["first"] + frame["items"])
            assert frame["line"] == 1 + bisect.bisect_left(ends, frame["start"])
            for row in rows:
                assert batch.line_of(row, place) == 1 + bisect.bisect_left(ends, batch.items["offset"][row])
            assert all(batch.items["frame"][row] == len(frames) for row in rows)
            frames.append(
                [(*batch.items[["code", "value", "flags"]][row].tolist(), batch.text_of(row)) for row in rows]
            )
            assert stream[frame["start"] : frame["start"] + 2] == b"&&"
            assert b"!!" in stream[frame["start"] : frame["stop"]]
        events += [(wits.RULE_NAMES[event["rule"]], int(event["line"])) for event in batch.events]
    assert text == stream[: len(text)]
    return frames, events, parser


def same(a, b) -> bool:
    """Equal with NaN = NaN and signed zeros apart."""
    return repr(a) == repr(b)


pieces = st.sampled_from(
    [b"\x02", b"\x03", b"&& \r\r\n", b" !!\0\n",
     b"&&", b"!!", b"\n", b"\r\n", b"\r\n", b"\r\n", b"\r\n", b"\r", b"0108", b"3650.40", b"-9999.00", b"&", b"!", b" ",
     b"&&\r\n01081\r\n!!\r\n", b"2210Watch out!! kick && run", b"nan", b"x" * 9, b"7" * 21, b"\0\xff", b"1e5",
     b"!!&&\n"]
)  # fmt: skip
limits = st.fixed_dictionaries(
    {"line_limit": st.sampled_from([16, 24, 1024]), "frame_limit": st.sampled_from([16, 40, 65536]),
     "item_limit": st.sampled_from([1, 3, 512])}
)  # fmt: skip


@settings(max_examples=400, deadline=None)
@given(st.lists(pieces, max_size=60).map(b"".join), limits, st.randoms())
def test_any_chunking_gives_what_the_slow_reader_gives(stream, limit, random):
    stream += b"\r\n"
    expected_frames, expected_events = slow_read(stream, **limit)
    cuts = sorted(random.choices(range(len(stream) + 1), k=random.randrange(12)))
    for chosen in ((), cuts, range(1, len(stream))):
        frames, events, parser = read(stream, chosen, **limit)
        assert same(frames, expected_frames)
        assert events == expected_events
        counts = parser.counts
        assert counts["bytes"] == len(stream)
        assert counts["lines"] == stream.count(b"\n")
        assert counts["frames"] == len(frames)
        assert {name: counts[name] for name in wits.RULES} == {
            name: sum(rule == name for rule, _ in events) for name in wits.RULES
        }


@settings(max_examples=400, deadline=None)
@given(st.floats(allow_nan=False, allow_infinity=False), st.sampled_from(["r", ".3f", ".9e", ".0f", "+.2f"]))
def test_a_number_has_the_bits_that_python_reads(value, form):
    text = (repr(value) if form == "r" else format(value, form)).encode()
    frames, _, _ = read(b"&&\n0108" + text + b"\n!!\n")
    assert same(frames[0][0][1:3], slow_number(text, wits.NULLS))


@given(st.binary(max_size=40).filter(lambda b: b"\n" not in b and not b.endswith(b"\r")))
def test_any_text_is_a_strict_number_or_flagged(text):
    frames, _, _ = read(b"&&\n0108" + text + b"\n!!\n")
    text = text.rstrip(PADDING)
    assert same(frames[0][0], (108, *slow_number(text, wits.NULLS), text))


@pytest.mark.parametrize(
    "text",
    ["nan", "inf", "-inf", "NAN", "infinity", "1_2", "1.2.3", "1,5", "1e400", "0x10", "--1", "+-1", "+", "-", ".", "1e",
     "e5", "1 2", "1\t", "WELL-1", "\u0661"],
)  # fmt: skip
def test_what_is_not_a_number_is_invalid_and_its_text_is_kept(text):
    frames, events, parser = read(b"&&\r\n0108" + text.encode() + b"\r\n!!\r\n")
    code, value, flags, raw = frames[0][0]
    assert (code, flags, raw) == (108, wits.INVALID, text.encode())
    assert math.isnan(value)
    assert events == []
    assert parser.counts["not_numbers"] == 1


@pytest.mark.parametrize("text", ["", "   ", "-9999", "-9999.00", "-8888.0", "-999.25", "-9.99925e3", " -9999", "-999"])
def test_nulls_are_compared_as_numbers(text):
    frames, _, parser = read(b"&&\n0108" + text.encode() + b"\n!!\n")
    assert frames[0][0][2] == wits.NULL
    assert math.isnan(frames[0][0][1])
    assert parser.counts["nulls"] == 1


def test_nulls_belong_to_the_source_and_are_not_a_matter_of_size():
    assert read(b"&&\n0171-4066.40\n0108-9999\n!!\n", nulls=[9999.0])[0][0] == [
        (171, -4066.4, 0, b"-4066.40"),
        (108, -9999.0, 0, b"-9999"),
    ]


def test_delimiters_within_text_do_not_break_a_frame():
    frames, events, _ = read(b"&&\r\n2210Watch out!! kick && !!\r\n01085\r\n!!\r\n")
    assert [(row[0], row[3]) for row in frames[0]] == [(2210, b"Watch out!! kick && !!"), (108, b"5")]
    assert events == []


def test_vendor_frames_blank_lines_unlisted_records_and_a_missing_line_end():
    stream = (
        b"\r\n\r\n&&\r\n1984PASON/EDR\r\n01083650.40\r\n63101\r\n99992\r\n!!\r\n\r\n&&\n0199-1\n!!&&\r\n01081\r\n!!"
    )
    frames, events, parser = read(stream)
    assert [[row[0] for row in frame] for frame in frames] == [[1984, 108, 6310, 9999], [199]]
    last = parser.finish()
    assert last.items["value"].tolist() == [1.0]
    assert events == []


def test_events_name_line_offset_and_rule():
    stream = b"hello\r\nthere\r\n&&\r\n0108x\r\nJUNK\r\n0000\r\n&&\r\n01081\r\n!!\r\n!!\r\n&&\r\n0108"
    parser = wits.Parser()
    batch = parser.feed(stream)
    ended = parser.finish()
    reported = [
        (wits.RULE_NAMES[e["rule"]], int(e["line"]), stream[e["offset"] : e["offset"] + e["length"]])
        for e in [*batch.events, *ended.events]
    ]
    assert reported == [
        ("stray_text", 1, b"hello"),
        ("not_an_item", 5, b"JUNK"),
        ("not_an_item", 6, b"0000"),
        ("unclosed", 3, b"&&"),
        ("stray_end", 10, b"!!"),
        ("cut_off", 11, b"&&"),
    ]
    assert parser.counts["stray_lines"] == 2
    assert len(batch.frames) == 1


def test_a_new_stream_after_finish_begins_outside_a_frame():
    parser = wits.Parser()
    parser.feed(b"&&\n0108")
    parser.finish()
    batch = parser.feed(b"1\n!!\n&&\n01082\n!!\n")
    assert batch.items["value"].tolist() == [2.0]
    assert [wits.RULE_NAMES[r] for r in batch.events["rule"]] == ["stray_text", "stray_end"]


GOOD = b"&&\r\n010842\r\n!!\r\n"


@pytest.mark.parametrize(
    "hostile",
    [b"&&\r\n" + b"01081\r\n" * 300_000, b"&&\n0108" + b"7" * 3_000_000 + b"\n", b"\0\xff\x80" * 900_000 + b"\n",
     b"&&" * 1_000_000 + b"\n", b"&&\n" * 900_000, b"!!\n" * 900_000, b"\r" * 2_000_000 + b"\n"],
    ids=["no end", "long number", "noise", "one line of delimiters", "begins", "ends", "returns"],
)  # fmt: skip
def test_hostile_input_holds_little_and_the_next_frame_is_read(hostile):
    parser = wits.Parser()
    held = values = 0
    for start in range(0, len(hostile), 65536):
        batch = parser.feed(hostile[start : start + 65536])
        held = max(held, parser.counts["bytes"] - (batch.base + len(batch.text)))
        values += len(batch.items)
    assert held <= 65536 + 1024 + 8
    assert values == 0
    assert parser.feed(b"\r\n" + GOOD).items["value"].tolist() == [42.0]


def test_one_byte_chunks_of_a_long_frame_stay_linear():
    stream = b"&&\n" + (b"2210" + b"x" * 996 + b"\n") * 60 + b"!!\n"
    frames, _, _ = read(stream, range(1, len(stream)))
    assert len(frames[0]) == 60


def test_numbers_of_any_length_have_the_bits_of_the_slow_reader():
    draw = np.random.default_rng(8)
    letters = np.frombuffer(b"0123456789012345678901234567890123456789..-+eEx/:\0\xb0\xff", np.uint8)
    texts = [b".", b"-", b"-.", b"..", b"+.", b"0.", b".0", b"-0", b"99999999", b".9999999", b"9999999."]
    texts += [bytes(draw.choice(letters, draw.integers(1, 20))) for _ in range(20_000)]
    texts += [b"%.*f" % (int(draw.integers(0, 9)), draw.normal(0, 10.0 ** draw.integers(0, 7))) for _ in range(20_000)]
    lines = [b"0108" + text + b"\n" for text in texts]
    frames = [b"".join(lines[start : start + 500]) for start in range(0, len(lines), 500)]
    found = read(b"".join(b"&&\n" + frame + b"!!\n" for frame in frames))[0]
    for text, (_, value, flags, raw) in zip(texts, itertools.chain(*found), strict=True):
        assert raw == text.rstrip(PADDING)
        assert same((value, flags), slow_number(raw, wits.NULLS)), text


def test_limits_and_nulls_are_checked(golden):
    with golden.raises():
        wits.Parser(nulls=[1.0, math.nan])
    with golden.raises():
        wits.Parser(line_limit=3)
    with golden.raises():
        wits.Parser(item_limit=0)


@pytest.mark.parametrize("text", ["", "108", "0008", "0100", "01o8", "01081", "\u0661\u0661\u0661\u0661"])
def test_item_codes_are_four_digits(text, golden):
    with golden.raises(kind=ValueError):
        wits.code(text)
    assert wits.code("0108") == 108


def test_what_is_written_is_read():
    text = wits.frame([(108, "3650.4"), (2210, "kick"), (9999, "")])
    assert text == b"&&\r\n01083650.4\r\n2210kick\r\n9999\r\n!!\r\n"
    assert same(read(text)[0], slow_read(text)[0])
    assert wits.HEARTBEAT == b"&&\r\n0111-9999\r\n!!\r\n"
    assert read(wits.POLL)[0] == [[]]


def test_threads_share_a_parser_without_losing_bytes():
    parser = wits.Parser()
    found = []

    def feed():
        for _ in range(200):
            found.append(len(parser.feed(GOOD * 20).frames))

    threads = [threading.Thread(target=feed) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sum(found) == parser.counts["frames"] == 4 * 200 * 20


def test_the_arrays_are_owned():
    batch = wits.Parser().feed(GOOD)
    values = batch.items["value"]
    del batch
    assert np.array_equal(values, [42.0])


@pytest.mark.parametrize(
    "change",
    [
        lambda text: text.replace(b"\r\n", b"\n"),
        lambda text: text.replace(b"\r\n", b"\r\r\n"),
        lambda text: text.replace(b"&&", b"&& ").replace(b"!!", b"!! "),
        lambda text: text.replace(b"\r\n", b"\r\n\0\0\0"),
        lambda text: text.replace(b"\r\n", b"\0\0\r\n"),
        lambda text: b"\x02" + text.replace(b"!!", b"!!\x03"),
        lambda text: b"".join(b"  " + line for line in text.splitlines(keepends=True)),
    ],
)
def test_what_senders_put_around_lines_is_left_out(change):
    plain = wits.frame([(108, "2010.25"), (5010, "33"), (113, "-9999")]) * 3
    expected, _, _ = read(plain)
    frames, events, _ = read(change(plain))
    assert same(frames, expected)
    assert events == []
