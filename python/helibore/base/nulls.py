"""The numbers that logs write where there is no measurement. A format that declares its own number adds it to these."""

NULLS = (-999.25, -9999.0, -9999.25)
