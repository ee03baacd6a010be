"""The numbers that logs write where there is no measurement. A format that declares its own number adds it to these."""

NULLS = (-999.25, -9999.0, -9999.25)


def say_so(number: str = "NUMBER") -> str:
    """Return advice for users: the setting that declares a number to mean "no value"."""
    return f"nulls={number} says so"
