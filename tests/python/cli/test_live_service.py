"""The unit and the compose file of docs/live.md: the command has their options, and systemd and docker read them."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import click
import pytest
from locations import ROOT

from helibore.cli import cli

PAGE = (ROOT / "docs/live.md").read_text()
(UNIT,) = re.findall(r"```ini\n(.*?)```", PAGE, re.DOTALL)
(COMPOSE,) = re.findall(r"```yaml\n(.*?)```", PAGE, re.DOTALL)


def parsed(words):
    """The options that ``helibore live`` reads from a command."""
    command = cli.get_command(click.Context(cli), "live")
    assert command is not None
    assert words[1] == "live"
    return command.make_context("live", words[2:]).params


def test_the_command_reads_the_options_of_the_unit():
    command = re.search(r"^ExecStart=((?:.*\\\n)*.*)$", UNIT, re.MULTILINE)
    options = parsed(command[1].replace("\\\n", " ").split())
    assert (options["journal"], options["metrics_port"]) == (Path("/var/lib/helibore/well-7.journal"), 9109)
    assert (options["log"], options["quiet"]) == ("/var/log/helibore/events.log", True)


@pytest.mark.skipif(shutil.which("systemd-analyze") is None, reason="systemd is not installed")
def test_systemd_reads_the_unit(tmp_path):
    unit = tmp_path / "helibore.service"
    unit.write_text(UNIT.replace("/opt/helibore/bin/helibore", sys.executable).replace("User=helibore\n", ""))
    found = subprocess.run(["systemd-analyze", "verify", str(unit)], capture_output=True, text=True, check=False)
    assert "helibore.service" not in found.stderr, found.stderr


def test_the_command_reads_the_options_of_the_compose_file():
    yaml = pytest.importorskip("yaml", reason="PyYAML is not installed")
    service = yaml.safe_load(COMPOSE)["services"]["helibore"]
    options = parsed(service["command"])
    assert (options["host"], options["view_port"], options["page"]) == ("0.0.0.0", 8443, True)
    assert options["certificate"] == "/settings/certificate.pem"
    assert service["ports"] == [f"{port}:{port}" for port in (options["metrics_port"], options["view_port"])]


def config(file, **environment):
    """What ``docker compose config`` says of a file."""
    command = ["docker", "compose", "-f", str(file), "config"]
    environment |= {"PATH": os.environ["PATH"]}
    return subprocess.run(command, capture_output=True, text=True, check=False, env=environment)


def test_docker_reads_the_compose_file(tmp_path):
    docker = shutil.which("docker")
    if docker is None or subprocess.run([docker, "compose", "version"], capture_output=True, check=False).returncode:
        pytest.skip("docker compose is not installed")
    file = tmp_path / "compose.yaml"
    file.write_text(COMPOSE)
    assert "set a secret" in config(file).stderr
    assert config(file, HELIBORE_TOKEN="x").returncode == 0
