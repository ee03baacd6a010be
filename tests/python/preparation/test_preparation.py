"""Preparing readings: each step does what its module does, in the order stated, and reports what it dropped."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from golden_texts import Golden
from wall_samples import wall_samples

import helibore as hb
from helibore.channels.channel_readings import readings
from helibore.channels.log_set import LogSet
from helibore.channels.role_map import overlay
from helibore.channels.roles import guess
from helibore.files.raw_set import Channel
from helibore.preparation.biases import arm_sides, find_bias
from helibore.preparation.centre_paths import find_centre_path
from helibore.preparation.conditioning import Step
from helibore.preparation.eccentering import turn_positions
from helibore.preparation.passes import choose
from helibore.preparation.prepare import Preparation, Track, prepare
from helibore.preparation.readings import Readings
from helibore.preparation.sensors import Sensor, TimeSeries
from helibore.preparation.shifts import find_shifts
from helibore.trajectory.references import from_high_side, onto_path

N = 400


def log(name: str = "f.csv", **columns: Any) -> LogSet:
    channels = []
    for key, values in columns.items():
        label, _, unit = key.partition("__")
        channels.append(Channel(label, unit, "", np.array(values)))
    return LogSet(Path(name), "s", channels, channels[0].shape[0])


def rotating(seed: int = 0, name: str = "f.csv", **more: Any) -> LogSet:
    """A tool that turns 33 deg a row while it goes down 2 mm, in an oval hole."""
    rng = np.random.default_rng(seed)
    k = np.arange(N)
    turn = k * 33.0 % 360
    radius = 0.108 + 0.002 * np.cos(np.radians(2 * turn)) + rng.normal(0, 2e-4, N)
    columns = {"md__m": 100 + 0.002 * k, "tf__deg": turn, "radius__m": radius} | more
    return log(name, **columns)


def arms(seed: int = 0, **more: Any) -> LogSet:
    """An X-Y caliper: two diameters, x and y, with a bearing."""
    rng = np.random.default_rng(seed)
    k = np.arange(N)
    x, y = 8.5 + 0.1 * np.sin(k / 9) + rng.normal(0, 0.01, (2, N))
    return log(**({"md__m": 100 + 0.05 * k, "rb__deg": k * 3.0 % 360, "cal_x__in": x, "cal_y__in": y} | more))


def test_nothing_asked_is_nothing_done() -> None:
    one = rotating()
    found = prepare(one.readings())
    samples = wall_samples(one)
    for name in ("depth", "toolface", "radius"):
        np.testing.assert_array_equal(getattr(found.caliper, name), getattr(samples, name))
    assert (found.report, found.counts, found.centres, found.earlier) == ((), {"kept": N}, None, None)
    assert found.pass_number is None
    assert Preparation().changed() == {}
    assert hb.Preparation is Preparation
    assert hb.prepare is prepare


def test_range_interval_repeated_are_counted_in_words(golden: Golden) -> None:
    radius = np.full(N, 0.1)
    radius[[3, 4]] = 0.0, 3.0
    depth = 100 + 0.01 * np.arange(N)
    depth[7] = depth[6]
    turn = np.arange(N) * 7.0 % 360
    turn[7] = turn[6]
    one = log(md__m=depth, tf__deg=turn, radius__m=radius)
    settings = Preparation(shallowest=100.015, deepest=103.0, least_radius=0.05, greatest_radius=0.5, repeated=True)
    found = prepare(one.readings(), settings)
    assert {label: line for label, line in found.report if label != "spikes"} == {
        "interval": "dropped 101 of 400 samples (2 below, 99 above)",
        "range": "dropped 2 of 299 samples (1 below, 1 above)",
        "repeated rows": "dropped 1 of 297 samples (1 repeated)",
    }
    assert found.counts == {"interval": 101, "range": 2, "repeated rows": 1, "kept": 296}
    with golden.raises():
        prepare(one.readings())
    with pytest.raises(hb.InputError) as caught:
        prepare(one.readings(), Preparation(recentre=True))
    rule = (
        "must be above 0 and at most 2 m; preparation.least_radius drops such radii; if the number of the "
        "file means no value, nulls=NUMBER says so"
    )
    assert str(caught.value) == f"f.csv, row 3, column radius: radius 0 m: {rule}"
    twice = Readings(**(vars(rotating().readings()) | {
        name: np.tile(getattr(rotating().readings(), name), 2) for name in ("depth", "toolface")
    } | {"radii": (np.tile(rotating().readings().radii[0], 2),)}))  # fmt: skip
    text = (
        "50 % of the samples have the depth, toolface and radius of an earlier sample, and count again; "
        "preparation.repeated=true drops them"
    )
    assert prepare(twice).report == (("repeated", text),)
    assert prepare(twice, Preparation(repeated=True)).counts == {"repeated rows": N, "kept": N}
    with golden.raises():
        prepare(one.readings(), Preparation(least_radius=4.0))


def test_closed_and_stuck_rows_go_before_anything_else(golden: Golden) -> None:
    one = arms()
    x, y = (np.array(one[name].values) for name in ("cal_x", "cal_y"))
    x[10:20] = y[10:20] = 4.0
    x[100:200] = 8.6
    one = arms(cal_x__in=x, cal_y__in=y)
    found = prepare(one.readings(), Preparation(closed=2 * 0.0254, stuck=60))
    assert found.report[:2] == (
        ("closed", "dropped 10 of 400 rows (10 closed)"),
        ("stuck", "dropped 100 of 800 readings (100 stuck)"),
    )
    assert len(found.caliper) == 4 * N - 40 - 200
    with golden.raises():
        prepare(rotating().readings(), Preparation(stuck=50))


def test_spikes_by_rotation_and_by_height(golden: Golden) -> None:
    one = rotating()
    radius = np.array(one["radius"].values)
    radius[[50, 222]] = 0.19
    found = prepare(rotating(radius__m=radius).readings())
    assert found.counts["spikes"] == 2
    assert found.caliper.radius.max() < 0.12
    by_height = prepare(rotating(radius__m=radius).readings(), Preparation(turn_height=0.05))
    assert by_height.counts["spikes"] == 2
    assert prepare(rotating(radius__m=radius).readings(), Preparation(turn_spikes=None)).caliper.radius.max() == 0.19
    far = rotating(r2__m=radius)
    roles = overlay(guess(far), far, {"r2": {"role": "radius", "angle": 0.0, "offset": 6.0}})
    apart = prepare(readings(far, roles), Preparation(turn_height=0.05))
    assert apart.counts["spikes"] == 2
    still = log(md__m=np.arange(N), radius__m=radius)
    roles = overlay(guess(still), still, {"radius": {"angle": 0.0}})
    with golden.raises():
        prepare(still.readings(roles), Preparation(spikes=6.0))


def test_what_another_pass_saw_at_its_depth_is_no_spike() -> None:
    """A niche one sample wide and one turn high, 40 turns apart in time: what confirms it is near in depth only."""
    k = np.arange(960)
    columns = {"md__m": np.tile(100 + 0.001 * k, 2), "tf__deg": np.tile(k * 15.0 % 360, 2)}
    columns["pass"] = np.repeat([1, 2], 960)
    radius = np.full(1920, 0.1)
    radius[[500, 960 + 500]] = 0.13
    both = prepare(log(**columns, radius__m=radius).readings())
    assert both.counts == {"kept": 1920}
    radius[960 + 500] = 0.1
    alone = prepare(log(**columns, radius__m=radius).readings())
    assert alone.counts == {"spikes": 1, "kept": 1919}


def test_recentre_follows_the_path_of_the_centre(golden: Golden) -> None:
    one = rotating()
    angle = np.radians(one["tf"].values)
    rng = np.random.default_rng(8)
    away = 0.006 * np.cos(angle - 1.0)
    radius = -away + np.sqrt(0.1**2 - (0.006 * np.sin(angle - 1.0)) ** 2) + rng.normal(0, 3e-4, angle.size)
    found = prepare(rotating(radius__m=radius).readings(), Preparation(recentre=True), bit_diameter=0.2)
    position = turn_positions(one["tf"].values)
    turn = np.floor(position).astype(int)
    path = find_centre_path(one["tf"].values, radius, position, 0.2)
    assert path is not None
    centre, rests, moves = path.at(position)
    assert rests.all()
    assert moves.all()
    np.testing.assert_allclose(found.caliper.radius, np.abs(centre + radius * np.exp(1j * angle)), rtol=1e-12)
    assert np.sqrt(np.mean(np.square(found.caliper.radius - 0.1))) < 4e-4
    assert found.centres is not None
    np.testing.assert_allclose(found.centres.eccentering, 0.006, atol=3e-4)
    assert found.centre_depth is not None
    np.testing.assert_allclose(
        found.centre_depth, [100 + 0.002 * np.flatnonzero(turn == t).mean() for t in np.unique(turn)]
    )
    assert found.report[1][1].startswith("37 of 37 turns corrected; offset of the tool 6.0 mm (median)")
    plain = prepare(rotating(radius__m=radius).readings(), Preparation(recentre=True))
    golden(plain.report[1:])
    np.testing.assert_array_equal(plain.caliper.radius, radius)
    wide = prepare(rotating(radius__m=radius).readings(), Preparation(recentre=True), bit_diameter=0.19)
    golden(wide.report[1:])
    with golden.raises():
        prepare(arms().readings(), Preparation(recentre=True))


def test_a_tool_that_whirls_is_corrected_at_any_rate() -> None:
    position = np.arange(40 * 64) / 64
    for rate in (84, 150, 300, -84):
        centre = 0.01 * np.exp(1j * np.radians(rate * position - 360 * position))  # as the turning tool sees it
        noise = np.random.default_rng(0).normal(0, 2e-4, position.size)
        radius = -centre.real + np.sqrt(0.11**2 - centre.imag**2) + noise
        one = log(md__m=100 + 0.1 * position, tf__deg=360 * position % 360, radius__m=radius)
        for bit in (0.216, None):
            found = prepare(one.readings(), Preparation(recentre=True), bit_diameter=bit)
            assert np.sqrt(np.mean(np.square(found.caliper.radius - 0.11))) < 3e-4


def several(seed: int = 0) -> LogSet:
    """Three passes over one rough hole, the second 0.4 m off in depth, the third 1 mm too large."""
    rng = np.random.default_rng(seed)
    depth = np.tile(np.arange(0, 30, 0.05), 3)
    number = np.repeat([1, 2, 3], depth.size // 3)
    turn = rng.random(depth.size) * 360
    rough = np.interp(np.arange(-5, 70, 0.05), np.arange(-5, 70.0, 0.5), rng.normal(0, 0.003, 150))
    true = 0.108 + np.interp(depth, np.arange(-5, 70, 0.05), rough)
    return log(
        md__m=1000 + depth - 0.4 * (number == 2),
        tf__deg=turn,
        radius__m=true + 0.001 * (number == 3),
        **{"pass": number},
    )


def test_passes_shift_bias_choice_and_comparison() -> None:
    one = several()
    settings = Preparation(passes=(1, 2, 3), find_shifts=True, bias="arm")
    found = prepare(one.readings(), settings)
    samples, number = wall_samples(one), one["pass"].values.astype(int)
    shifts = find_shifts(samples.depth, samples.toolface, samples.radius, number)
    assert found.shifts is not None
    np.testing.assert_array_equal(found.shifts.shift, shifts.shift)
    assert shifts.shift[1] - shifts.shift[0] == pytest.approx(0.4, abs=0.02)
    bias = find_bias(
        samples.depth + shifts.at(number, samples.depth),
        samples.toolface,
        samples.radius,
        number,
        np.zeros(number.size),
    )
    assert found.bias is not None
    np.testing.assert_allclose(found.bias.by_pass, bias.by_pass, atol=1e-12)
    np.testing.assert_allclose(found.caliper.radius, samples.radius - bias.by_pass[number - 1], atol=1e-9)
    labels = ["passes", "passes", *["shift"] * 5, "bias", "bias", "bias", "bias", "bias"]
    assert [label for label, _ in found.report] == labels
    assert found.report[7][1] == f"subtracted; noise of the corrected samples {1e3 * found.bias.noise:.2f} mm"
    assert found.report[8][1].startswith("pass 1, mm: radius -0.")
    assert found.report[11][1].startswith("passes or arms disagree by more than their noise (0.")
    silent = prepare(one.readings(), Preparation(find_shifts=True)).report[-1]
    assert silent[0] == "bias"
    assert "radius of pass 3 reads +0." in silent[1]
    assert silent[1].endswith("; preparation.bias=arm subtracts it")
    held = prepare(one.readings(), Preparation(shifts=((2, 0.0),), find_shifts=True))
    assert held.shifts is not None
    np.testing.assert_allclose(held.shifts.shift, [-0.4, 0, -0.4], atol=0.02)
    lines = [line for label, line in held.report if label == "shift"]
    assert [line.split(":")[0] for line in lines] == ["pass 2", "pass 1", "pass 1", "pass 3", "pass 3"]
    given = prepare(one.readings(), Preparation(shifts=((2, 0.4),), latest=True, passes=(3, 2)))
    assert ("shift", "pass 2: +0.400 m, as given") in given.report
    assert given.pass_number is not None
    assert set(given.pass_number.tolist()) == {2}  # the last of (3, 2)
    expected = choose(number[number > 1], (samples.depth + 0.4 * (number == 2))[number > 1], (3, 2), latest=True)
    assert given.counts["passes"] == int(expected.dropped.sum()) + int((number == 1).sum())
    plain, turned = (
        prepare(one.readings(), Preparation(toolface_shifts=of, passes=(1, 2, 3))) for of in ((), ((2, 370.0),))
    )
    assert plain.pass_number is not None
    expected_toolface = (plain.caliper.toolface + 10 * (plain.pass_number == 2)) % 360
    np.testing.assert_allclose(turned.caliper.toolface, expected_toolface, atol=1e-9)
    compared = prepare(one.readings(), Preparation(earlier=(1,), passes=(3,)))
    assert compared.earlier is not None
    assert (len(compared.earlier), len(compared.caliper)) == ((number == 1).sum(), (number == 3).sum())
    rest = prepare(one.readings(), Preparation(earlier=(1,)))
    assert len(rest.caliper) == (number > 1).sum()
    assert ("compared", "passes 2, 3 beside earlier pass 1") in rest.report
    (apart,) = (said for step, said in prepare(one.readings(), Preparation(earlier=(1,), shifts=((1, 1000.0),))).report
                if step == "compared")  # fmt: skip
    top, bottom = rest.caliper.depth.min(), rest.caliper.depth.max()
    ends = f"{top:.1f} to {bottom:.1f} m, and {compared.earlier.depth.min() + 1000:.1f} to "
    assert apart.startswith(f"passes 2, 3 beside earlier pass 1, which they do not overlap ({ends}")
    assert apart.endswith(" m): no place has a difference")
    whole = prepare(one.readings(), Preparation(earlier=(1,), passes=(1, 2, 3)))  # as without passes
    assert whole.caliper.radius.tobytes() == rest.caliper.radius.tobytes()
    last = prepare(one.readings(), Preparation(earlier=(1,), passes=(1, 3, 2), latest=True)).pass_number
    assert last is not None
    assert 1 not in last
    none_left = "all passes in use are earlier ones: no pass is left to make the wall from"
    for bad, rule in (
        (Preparation(passes=(9,)), "f.csv: pass 9: is not among the passes of the samples: 1, 2, 3"),
        (
            Preparation(toolface_shifts=((9, 1.0),)),
            "f.csv: toolface shift 9=1 deg: is not among the passes of the samples",
        ),
        (Preparation(shifts=((9, 1.0),)), "f.csv: shift 9=1 m: is not among the passes of the samples"),
        (Preparation(earlier=(1, 2, 3)), f"f.csv: earlier passes 1, 2, 3: {none_left}"),
        (Preparation(passes=(1, 2), earlier=(1, 2)), f"f.csv: earlier passes 1, 2: {none_left}"),
    ):
        with pytest.raises(hb.InputError) as caught:
            prepare(one.readings(), bad)
        assert str(caught.value) == rule


def test_bias_by_side_takes_the_tool_bearing() -> None:
    one = arms(**{"pass": np.repeat([1, 2], N // 2), "md__m": np.tile(100 + 0.05 * np.arange(N // 2), 2)})
    found = prepare(one.readings(), Preparation(bias="side"))
    samples = wall_samples(one)
    arm = np.tile([0, 0, 1, 1], N)
    sides = arm_sides(arm, one["rb"].values[samples.row])
    number = one["pass"].values[samples.row]
    bias = find_bias(samples.depth, samples.toolface, samples.radius, number, sides, sides=8)
    np.testing.assert_allclose(found.caliper.radius, samples.radius - bias.at(number, sides), atol=1e-12)


def test_several_files_are_passes(golden: Golden) -> None:
    first, second = rotating(1, "a.csv").readings(), rotating(2, "b.csv").readings()
    found = prepare([first, second], Preparation(latest=True))
    assert found.pass_number is not None
    assert set(found.pass_number.tolist()) == {2}
    golden(found.report[0])
    merged = prepare([first, second])
    np.testing.assert_array_equal(merged.caliper.radius, np.concatenate([first.radii[0], second.radii[0]]))
    timed = rotating(3, "c.csv", time__s=np.arange(N)).readings()
    report = dict(prepare([first, timed]).report)
    assert report == {"time": "left out, because not every file has a time"}
    numbered = rotating(4, "d.csv", **{"pass": np.ones(N)}).readings()
    rule = "pass 1 is in another file too; number the passes anew"
    with pytest.raises(ValueError, match=f"^d.csv: {rule}$"):
        prepare([numbered, numbered], Preparation(latest=True))
    other = Readings(**(vars(numbered) | {"name": "e.csv", "pass_number": np.full(N, 2)}))
    with pytest.raises(ValueError, match=f"^d.csv: {rule}$"):  # not e.csv, the last file
        prepare([first, numbered, other], Preparation(latest=True))
    mixed = prepare([other, first], Preparation(latest=True))
    passes = "as the files number them, one for each file that numbers none; samples of each: 2 (400), 3 (400)"
    assert mixed.report[0] == ("passes", passes)
    alone = prepare(numbered, Preparation(latest=True))
    golden(alone.report[0])
    again = prepare([numbered, numbered], Preparation(latest=True, reversal=0.5))
    assert set((again.pass_number if again.pass_number is not None else np.empty(0)).tolist()) == {2}
    bad = Readings(**(vars(numbered) | {"radii": (np.where(np.arange(N) == 5, 5.0, numbered.radii[0]),)}))
    with golden.raises():
        prepare([first, bad])


def test_flat_tops_are_named_and_dropped(golden: Golden) -> None:
    one = arms()
    x = np.array(one["cal_x"].values)
    x[200:240] = 15.25  # 2 m
    x[300] = 15.25
    found = prepare(arms(cal_x__in=x).readings())
    golden(found.report[0])
    assert found.counts["saturated"] == 41, "a single reading at the limit is not the wall either"
    assert len(found.caliper) == 4 * N - 82
    kept = prepare(arms(cal_x__in=x).readings(), Preparation(saturated=False))
    assert "saturated" not in kept.counts
    assert len(kept.caliper) == 4 * N


def test_closed_arms_and_their_opening_are_dropped_without_being_asked() -> None:
    one = arms()
    columns = {}
    for name in ("cal_x", "cal_y"):
        values = np.array(one[name].values)
        values[350:] = 4.0  # going down: the tool was opened at the bottom and logged up
        values[340:350] = np.linspace(8.0, 4.4, 10)
        columns[f"{name}__in"] = values[::-1]
    columns["md__m"] = np.array(one["md"].values)[::-1]
    bit = 8.5 * 0.0254
    found = prepare(arms(**columns).readings(), bit_diameter=bit)
    stretch = "f.csv: all arms stay within 2 mm of a radius of 50.8 mm from 117.5 to 120.0 m"
    assert found.report[0] == ("closed", f"{stretch}, open until 116.9 m: 62 rows dropped")
    assert found.counts["closed"] == 62
    assert found.caliper.radius.min() > 0.09
    down = {name: values[::-1] for name, values in columns.items()}
    (line,) = [line for label, line in prepare(arms(**down).readings(), bit_diameter=bit).report if label == "closed"]
    assert line == f"{stretch}, close from 116.9 m: 62 rows dropped"
    for settings, size, done in (
        (Preparation(), None, "kept, although the arms may be closed; without a bit size, this may be casing"),
        (Preparation(drop_closed=False), bit, "kept, although the arms may be closed"),
    ):
        kept = prepare(arms(**columns).readings(), settings, bit_diameter=size)
        assert ("closed", f"{stretch}, open until 116.9 m: {done}") in kept.report
        assert len(kept.caliper) == 4 * N
    casing = prepare(arms(**columns).readings(), bit_diameter=4.0 * 0.0254)
    for other in (casing, prepare(arms().readings(), bit_diameter=bit)):
        assert not [line for line in other.report if line[0] == "closed"]
    asked = prepare(arms(**columns).readings(), Preparation(closed=2.0 * 0.0254))
    assert [label for label, _ in asked.report].count("closed") == 1
    assert asked.counts["closed"] == 50


def test_two_calipers_that_disagree_are_not_merged(golden: Golden) -> None:
    one = arms()
    x, y = (np.array(one[name].values) for name in ("cal_x", "cal_y"))
    twice = log(md__m=one["md"].values, rb__deg=one["rb"].values, cal_x__in=x, cal_z__in=y + 0.35)
    diameters = {name: {"role": "diameter", "angle": 0.0} for name in ("cal_x", "cal_z")}
    roles = overlay(guess(twice), twice, diameters)
    with golden.raises():
        prepare(twice.readings(roles))
    near = log(md__m=one["md"].values, rb__deg=one["rb"].values, cal_x__in=x, cal_z__in=y + 0.1)
    roles = overlay(guess(near), near, diameters)
    merged = prepare(near.readings(roles))
    assert len(merged.caliper) == 4 * N
    assert "arms" not in [label for label, _ in merged.report]
    part = log(md__m=one["md"].values, rb__deg=one["rb"].values, cal_x__in=x, cal_z__in=y + 0.35 * (np.arange(N) < 40))
    depth = part["md"].values
    assert prepare(part.readings(overlay(guess(part), part, diameters))).report[0] == (
        "arms",
        "f.csv: cal_x and cal_z look in the same direction and differ by more than 2.5 mm of radius in 40 rows, the "
        f"longest stretch from {depth[0]:.2f} to {depth[39]:.2f} m: name the caliper to use",
    )


def test_two_calipers_of_four_arms_are_no_imaging_tool() -> None:
    """Horizontal and vertical diameters of a density and of an ultrasonic caliper, as in 15/9-F-15 B: eight sensors."""
    rng = np.random.default_rng(5)
    sizes = {f"{name}__in": 8.5 + rng.normal(0, 0.02, N) for name in ("DCHO", "DCVE", "UCHO", "UCVE")}
    one = log(md__m=100 + 0.05 * np.arange(N), **sizes)
    roles = overlay(guess(one), one, {
        name: {"role": "diameter", "angle": angle}
        for name, angle in (("DCHO", 90.0), ("DCVE", 0.0), ("UCHO", 90.0), ("UCVE", 0.0))
    })  # fmt: skip
    found = one.readings(roles)
    assert (len(found.sensors), found.is_image) == (8, False)
    caliper = prepare(found).caliper
    assert caliper.arm is not None
    wall = hb.reconstruct(caliper, bit_diameter=8.5 * 0.0254)
    assert len(wall.logs().arm_diameter) == 2
    assert wall.summary().shape == "arms"
    far = log(md__m=100 + 0.05 * np.arange(N), **(sizes | {"UCHO__in": sizes["UCHO__in"] + 0.5}))
    with pytest.raises(hb.InputError) as caught:
        prepare(far.readings(roles))
    assert str(caught.value).startswith("f.csv: DCHO and UCHO: look in the same direction and differ by 6.")
    arms = tuple(Sensor(f"r{k}", offset=0.5 * (k % 2), mounting=45.0 * k) for k in range(8))
    staggered = replace(found, sensors=arms)
    assert not staggered.is_image  # two levels of four arms
    assert replace(found, sensors=tuple(replace(each, offset=0.0) for each in arms)).is_image


def test_spikes_of_diameters_without_toolface_are_judged_by_rows() -> None:
    rng = np.random.default_rng(6)
    sizes = {name: 8.5 + rng.normal(0, 0.02, N) for name in ("DCHO", "DCVE")}
    sizes["DCHO"][40] = 15.25
    one = log(md__m=100 + 0.05 * np.arange(N), **{f"{name}__in": size for name, size in sizes.items()})
    angles = (("DCHO", 90.0), ("DCVE", 0.0))
    roles = overlay(guess(one), one, {name: {"role": "diameter", "angle": angle} for name, angle in angles})
    caliper = prepare(one.readings(roles), Preparation(spikes=6.0)).caliper
    assert len(caliper) == 4 * N - 2
    assert caliper.radius.max() < 0.12


def building() -> hb.Survey:
    return hb.Survey([0.0, 50.0, 200.0], [0.0, 0.0, 60.0], [70.0, 70.0, 70.0])


def test_toolface_references(golden: Golden) -> None:
    survey = building()
    depth = np.linspace(5.0, 195.0, N)
    turn = np.arange(N) * 33.0 % 360
    columns = {"md__m": depth, "tf__deg": turn, "radius__m": np.full(N, 0.1)}
    transported = survey.path(reference="parallel-transport")
    steep = np.degrees(np.arccos(np.clip(transported.tangent(depth)[:, 2], -1, 1)))
    automatic = prepare(log(**columns).readings(), Preparation(toolface_from="automatic"), transported)
    expected = onto_path(turn, depth, transported, from_high_side(steep))
    np.testing.assert_array_equal(automatic.caliper.toolface, expected)
    tags = np.where(steep > 5, "GTF", "MTF")
    tagged = prepare(log(**columns, tf_type=tags).readings(), None, transported)
    np.testing.assert_array_equal(tagged.caliper.toolface, onto_path(turn, depth, transported, steep > 5))
    assert "by the file's tags" in tagged.report[0][1]
    one = log(**columns)
    mapped = overlay(guess(one), one, {"tf": {"reference": "north"}})
    north = prepare(one.readings(mapped), None, transported)
    np.testing.assert_array_equal(north.caliper.toolface, onto_path(turn, depth, transported, False))
    same = prepare(one.readings(mapped), None, survey.path(reference="north"))
    np.testing.assert_array_equal(same.caliper.toolface, turn)
    beyond = prepare(
        one.readings(mapped), None, hb.Survey([0, 100.0], [0.0, 9.0], [0.0, 0.0]).path(reference="parallel-transport")
    )
    golden(beyond.report[0])
    alone = prepare(one.readings(mapped))
    golden(alone.report)
    np.testing.assert_array_equal(alone.caliper.toolface, turn)
    with golden.raises():
        prepare(one.readings(mapped), Preparation(toolface_from="automatic"))
    with golden.raises():
        prepare(one.readings(), None, transported)
    with golden.raises():
        log(**columns, tf_type=np.where(np.arange(N) == 1, "up", "N")).readings()


NORTH = Preparation(toolface_from="north")
SHALLOW = hb.Survey([0.0, 50.0], [0.0, 0.0], [0.0, 0.0])


@pytest.mark.parametrize(
    ("one", "settings", "path"),
    [
        ([], None, None),
        (rotating(), None, SHALLOW.path(reference="parallel-transport")),
        (rotating(), Preparation(toolface_from="automatic"), None),
        (rotating(), NORTH, SHALLOW.path()),
        (arms(), Preparation(recentre=True), None),
        (rotating(), Preparation(latency=1.0), None),
        (rotating(), Preparation(stuck=50), None),
        (rotating(), Preparation(closed=0.3), None),
        (rotating(), Preparation(least_radius=4.0), None),
    ],
)  # fmt: skip
def test_what_cannot_be_prepared(one: Any, settings: Any, path: Any, golden: Golden) -> None:
    with golden.raises():
        prepare(one if isinstance(one, list) else one.readings(), settings, path)


def test_sensors_at_their_places_and_times(golden: Golden) -> None:
    time = np.arange(N, dtype=float)
    columns = {
        "time__s": time, "md__m": 100 + 0.01 * time, "tf__deg": time * 30.0 % 360, "radius__m": np.full(N, 0.1),
        "r2__m": np.full(N, 0.11),
    }  # fmt: skip
    one = log(**columns)
    roles = overlay(guess(one), one, {
        "radius": {"offset": 0.5, "angle": 10.0},
        "r2": {"role": "radius", "angle": 100.0, "offset": 1.5, "latency": 2.0},
    })  # fmt: skip
    found = prepare(readings(one, roles), Preparation(sensor_offset=0.25, latency=1.0))
    first = found.caliper.radius == 0.1
    np.testing.assert_allclose(found.caliper.depth[first], 100 + 0.01 * (time[1:] - 1.0) - 0.75)
    np.testing.assert_allclose(found.caliper.toolface[first], ((time[1:] - 1.0) * 30 + 10) % 360, atol=1e-9)
    np.testing.assert_allclose(found.caliper.depth[~first], 100 + 0.01 * (time[3:] - 3.0) - 1.75)
    np.testing.assert_allclose(found.caliper.toolface[~first], ((time[3:] - 3.0) * 30 + 100) % 360, atol=1e-9)
    assert found.caliper.time is not None
    assert (np.diff(found.caliper.time) >= 0).all()
    assert found.counts["no depth"] == 4
    untimed = log(**{key: value for key, value in columns.items() if key != "time__s"})
    with golden.raises():
        prepare(untimed.readings(), Preparation(latency=1.0))


def test_a_track_gives_depth_and_toolface_by_time() -> None:
    time = np.arange(50, dtype=float) + 0.5
    one = log(time__s=time, radius__m=np.full(50, 0.1))
    track = Track(
        TimeSeries(np.arange(52.0), 100 + 0.1 * np.arange(52.0)),
        TimeSeries(np.arange(52.0), 20.0 * np.arange(52.0) % 360, angle=True),
    )
    found = prepare(readings(one, tracked=True), None, None, track)
    np.testing.assert_allclose(found.caliper.depth, 100 + 0.1 * time)
    np.testing.assert_allclose(found.caliper.toolface, 20.0 * time % 360)


TIMES = np.arange(400.0)
TURNING = Track(
    TimeSeries(TIMES, np.concatenate([100 + 0.1 * TIMES[:200], 119.9 - 0.1 * TIMES[:200]])),
    TimeSeries(TIMES, 30.0 * TIMES % 360, angle=True),
)


def test_passes_are_numbered_by_the_depth_of_a_track(golden: Golden) -> None:
    one = readings(log(time__s=TIMES, radius__m=np.full(400, 0.1)), tracked=True)
    found = prepare(one, Preparation(reversal=5.0), None, TURNING)
    golden(found.report[0])


def test_a_tool_is_recentred_by_the_turns_of_a_track() -> None:
    """A round hole of 100 mm around a tool that lies 2 mm off its axis towards toolface 0."""
    toward = np.radians(30.0 * TIMES % 360)
    radius = np.sqrt(0.1**2 - (0.002 * np.sin(toward)) ** 2) - 0.002 * np.cos(toward)
    one = readings(log(time__s=TIMES, radius__m=radius), tracked=True)
    found = prepare(one, Preparation(recentre=True), None, TURNING, bit_diameter=0.2)
    assert found.centres is not None
    assert found.report[0] == ("turns", "34, by rotation; samples in a turn: 12")
    np.testing.assert_allclose(found.centres.x[1:-2], 0.002, atol=1e-4)
    np.testing.assert_allclose(found.caliper.radius[12:-24], 0.1, atol=1e-4)


def test_flat_tops_are_dropped_by_the_depth_of_a_track() -> None:
    radius = np.where((TIMES >= 50) & (TIMES < 70), 0.15, 0.1 + 1e-5 * TIMES)
    roles = {"first": 0.0, "second": 180.0}
    one = log(time__s=TIMES, **{f"{name}__m": radius for name in roles})
    mapped = overlay(guess(one), one, {n: {"role": "radius", "angle": a} for n, a in roles.items()})
    found = prepare(readings(one, mapped, tracked=True), None, None, TURNING)
    assert found.counts["saturated"] == 40
    assert found.caliper.radius.max() < 0.11


def test_a_row_whose_depth_and_toolface_are_interpolated_has_the_pass_and_turn_of_its_samples(golden: Golden) -> None:
    toolface, depth = 30.0 * TIMES % 360, 100 + 0.1 * TIMES
    toolface[50] = depth[70] = np.nan
    one = log(time__s=TIMES, md__m=depth, tf__deg=toolface, radius__m=np.full(400, 0.1)).readings()
    found = prepare(one, Preparation(latency=0.5, reversal=5.0, turn_height=None, recentre=True))
    golden(found.report[1])
    assert found.report[2] == ("turns", "34, by rotation; samples in a turn: 12")


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    ("first", "count", "counts"), [(0, 20, True), (0, 9, False), (100, 20, False), (N - 20, 20, True)]
)
def test_a_short_closed_stretch_counts_where_a_log_begins_or_ends(first: int, count: int, counts: bool) -> None:
    """Half a metre there, two metres between; rows lie 0.05 m apart."""
    one = arms()
    x, y = (np.array(one[name].values) for name in ("cal_x", "cal_y"))
    x[first : first + count], y[first : first + count] = 3.4, 3.6
    found = prepare(arms(cal_x__in=x, cal_y__in=y).readings(), bit_diameter=8.5 * 0.0254)
    assert (found.counts.get("closed", 0) >= count) == counts
    assert ("closed" in found.counts) == counts


def test_closed_arms_without_a_depth_are_reported_without_one() -> None:
    radius = np.where((TIMES >= 50) & (TIMES < 100), 0.08, 0.12)
    depth = np.where((TIMES >= 40) & (TIMES < 110), np.nan, 100 + 0.1 * TIMES)
    one = log(md__m=depth, tf__deg=TIMES % 360, radius__m=radius).readings()
    text = "f.csv: all arms stay within 2 mm of a radius of 80.0 mm in rows without a depth: 52 rows dropped"
    assert prepare(one, bit_diameter=0.216).report[0] == ("closed", text)


def test_what_closed_arms_leave_nothing_of_is_reported(golden: Golden) -> None:
    with golden.raises():
        prepare(rotating().readings(), Preparation(closed=0.3))


def two_passes(backwards: bool, **columns: Any) -> tuple[LogSet, Any]:
    """Down and up over 100 to 104 m, 20 s each, both by a clock that starts at 0; time as it went."""
    time = np.tile(np.arange(100) * 0.2, 2)
    depth = np.concatenate([100 + 0.2 * time[:100], 104 - 0.2 * time[100:]])
    arms = {"time__s": time, "md__m": depth, "tf__deg": time * 30.0 % 360, "radius__m": np.full(200, 0.1)} | columns
    return log(**{name: values[:: -1 if backwards else 1] for name, values in arms.items()}), time


def test_a_clock_that_starts_anew_with_each_pass() -> None:
    anew = ["f.csv: the time goes back, as if a clock restarts: read as 2 clocks"]
    for columns, backwards, lines in (
        ({"pass": np.repeat([3.0, 7.0], 100)}, False, []), ({}, False, anew), ({}, True, anew),
    ):  # fmt: skip
        one, time = two_passes(backwards, **columns)
        found = prepare(one.readings(), Preparation(latency=1.0))
        assert found.counts["no depth"] == 10
        late = time[5:100] - 1.0
        both = np.concatenate([100 + 0.2 * late, 104 - 0.2 * late])
        np.testing.assert_allclose(np.sort(found.caliper.depth), np.sort(both))
        assert [line for name, line in found.report if name == "time"] == lines


def test_rows_of_one_clock_may_come_in_any_order() -> None:
    time = np.random.default_rng(1).permutation(N).astype(float)
    columns = {"time__s": time, "md__m": 100 + 0.01 * time, "tf__deg": time * 30 % 360}
    found = prepare(log(**columns, radius__m=np.full(N, 0.1)).readings(), Preparation(latency=1.0))
    np.testing.assert_allclose(np.sort(found.caliper.depth), 100 + 0.01 * np.arange(N - 1.0))
    assert not [line for name, line in found.report if name == "time"]


def test_a_toolface_too_fast_to_be_read_between_is_reported() -> None:
    time = np.arange(N, dtype=float)
    columns = {"time__s": time, "md__m": 100 + 0.01 * time, "radius__m": np.full(N, 0.1)}
    slow, fast = (prepare(log(**columns, tf__deg=time * turn % 360).readings(), Preparation(latency=0.5))
                  for turn in (80.0, 110.0))  # fmt: skip
    line = (
        "toolface",
        "f.csv: half of the toolface readings differ by 110 deg or more from the reading before: how far the tool "
        "turned between readings is not known",
    )
    assert line in fast.report
    assert not [line for line in slow.report if line[0] == "toolface"]


def test_rows_without_a_time_are_left_out(golden: Golden) -> None:
    time = np.where(np.arange(N) == 9, np.nan, np.arange(N))
    found = prepare(rotating(time__s=time).readings())
    assert found.counts == {"no time": 1, "kept": N - 1}
    assert found.report == (("dropped", "1 samples of f.csv without a time"),)
    late = prepare(rotating(time__s=time).readings(), Preparation(latency=0.5))
    assert late.counts == {"no depth": 1, "no time": 1, "kept": N - 2}
    assert late.report[-1] == ("dropped", "1 samples of f.csv without a time")
    for more in ({}, {"pass": np.ones(N)}):
        with golden.raises():
            prepare(rotating(time__s=np.full(N, np.nan), **more).readings(), Preparation(latency=0.5))


@pytest.mark.parametrize(
    ("settings", "place"),
    [
        (
            {"toolface_from": "south"},
            "toolface_from",
        ),
        ({"bias": "tool"}, "bias"),
        ({"turn_height": 0.0}, "turn_height"),
        (
            {"least_radius": 2.0, "greatest_radius": 1.0},
            "least_radius",
        ),
        ({"shifts": ((1, 0.1), (1, 0.2))}, "shifts"),
        ({"passes": (2, 2)}, "passes"),
        ({"spikes": 0.0}, "spikes"),
        ({"closed": -1.0}, "closed"),
        ({"reversal": np.inf}, "reversal"),
        ({"stuck": 1}, "stuck"),
        ({"steep": 6.0, "level": 4.0}, "steep"),
    ],
)
def test_bad_settings(settings: dict[str, Any], place: str, golden: Golden) -> None:
    with golden.raises(place):
        Preparation(**settings)


def test_steps_of_one_kind_add_up() -> None:
    step = Step("x", {}, np.zeros(3, dtype=bool))
    assert step.kept.all()


def test_an_arm_that_does_not_move_is_reported_and_kept() -> None:
    rng = np.random.default_rng(5)
    depth = 100 + 0.02 * np.arange(600)
    moving, resting = (0.2 + 0.001 * rng.random(600) for _ in range(2))
    resting[200:450] = 0.19
    columns = {"md__m": depth, "rb__deg": np.arange(600.0) % 360, "calx__m": moving, "caly__m": resting}
    found = prepare(log(**columns).readings())
    line = ("stuck", "f.csv: caly does not move in 250 rows between 104.0 and 109.0 m while the other arms do: "
                     "kept; preparation.stuck=ROWS drops them")  # fmt: skip
    assert [each for each in found.report if each[0] == "stuck"] == [line]
    assert found.counts == {"kept": 2400}
    assert not [each for each in prepare(log(**columns).readings(), Preparation(stuck=50)).report if each == line]
    both = log(**columns | {"calx__m": np.where(resting == 0.19, 0.2, moving)})
    assert not [each for each in prepare(both.readings()).report if each[0] == "stuck"], "a smooth pipe"


def test_two_runs_in_one_file_that_disagree_are_reported(golden: Golden) -> None:
    rng = np.random.default_rng(6)
    depth = np.tile(100 + 0.02 * np.arange(1000), 2)
    toolface = np.arange(2000) * 23.0 % 360
    radius = 0.108 + np.repeat([0.0, 0.002], 1000) + rng.normal(0, 0.0002, 2000)
    found = prepare(log(md__m=depth, tf__deg=toolface, radius__m=radius).readings())
    lines = [text for name, text in found.report if name == "bias"]
    golden(lines)
    mixed = rng.permutation(2000)
    none = prepare(log(md__m=depth[mixed], tf__deg=toolface[mixed], radius__m=radius[mixed]).readings())
    assert not [text for name, text in none.report if name == "bias"], "rows in no order have no runs"
