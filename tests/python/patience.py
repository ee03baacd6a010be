"""How long a test waits before it takes what it waits for to be hung: the one limit by the clock of all tests."""

PATIENCE = 600.0
"""Seconds. A wait ends when its condition holds, so this costs time only in a test that fails anyway; the slowest wait
takes some 10 s on two idle processors, and a machine of a quarter of the speed, or one beside other work, must pass."""
