"""What ``helibore live --check`` says of each item, and what it refuses."""

from __future__ import annotations

import pytest
from click.testing import CliRunner
from live_wires import WALL

from helibore.cli import cli
from helibore.cli.live_check import described
from helibore.live.rules.configuration import parse

WITS = (
    WALL + '[source.rig]\naddress = "tcp://10.1.0.7:9872"\nunits = "fps"\nsurvey = {}\n'
    'items = { bit_depth = "0108", hole_depth = { item = "0110", unit = "m" }, rotation = "0120" }\n'
    'caliper = { first = "5010", groups = 2, order = ["toolface", "radius"], measures = "diameter", offset = 12.0 }\n'
    'image.GR = { first = "5110", count = 4, unit = "gAPI", origin = "edge", reference = "high-side" }\n'
)
STORE = (
    WALL + '[source.store]\naddress = "https://store.example/witsml"\n'
    'log = { well = "a", wellbore = "b", log = "c", index = "depth" }\n'
    'caliper = { toolface = ["TF1", "TF2"], radius = ["R1", "R2"] }\n'
)


def test_each_item_is_said_with_its_unit_and_a_number_to_compare(golden):
    golden(described(parse(WITS)))


def test_a_store_sends_the_units_of_its_curves(golden):
    golden(described(parse(STORE)))


@pytest.mark.parametrize(
    ("alarms", "error"),
    [
        ('command = ["/no/such/horn"]', "alarms.command[0] = '/no/such/horn': must be a program that can be run"),
        ('webhook = "env:NO_SUCH"', "alarms.webhook = 'env:NO_SUCH': is not set in the environment"),
    ],
)
def test_alarms_that_could_not_be_delivered_are_refused(tmp_path, alarms, error):
    (tmp_path / "rig.toml").write_text(f"{WITS}[alarms]\n{alarms}\n")
    result = CliRunner().invoke(cli, ["live", str(tmp_path / "rig.toml"), "--check"])
    assert result.exit_code != 0
    assert error in f"{result.output}{result.exception}"
