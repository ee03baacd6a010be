"""Addresses in texts lose their secrets, and nothing else."""

from __future__ import annotations

import pytest

from helibore.base.addresses import file_name, split_credentials, without_secrets


@pytest.mark.parametrize(
    "address",
    [
        "https://rig:s3cret@store.example/x.las",
        "https://rig:a%40s3cret@store.example:8443/x.las?y=1",
        "https://bucket.example/x.las?X-Amz-Credential=AK&X-Amz-Signature=s3cret",
        "s3://s3cret:s3cret@bucket/x.las",
        "abfs://field/x.las?sig=s3cret",
        "tcp://rig:s3cret@10.0.0.7:80",
        "mqtts://u:p@s3cret@h:1",
    ],
)
def test_no_secret_of_an_address_stays_in_a_text(address):
    for text in (address, f"well A: {address}: no such file", f"Cannot open URL('{address}'), tried <{address}>"):
        shown = without_secrets(text)
        assert "s3cret" not in shown
        assert len(shown.split()) == len(text.split())
        assert without_secrets(shown) == shown


@pytest.mark.parametrize(
    "text",
    [
        "x.las, line 12, column GR = 3: must be finite; write to rig@field.example",
        "https://store.example/witsml/x.las: no such file",
        "file:///data/x@2.las?speed=960: must be ...",
        "serial:///dev/ttyS0?baud=9600",
        "s3://bucket/a b@0.las",
    ],
)
def test_what_is_no_secret_stays(text):
    assert without_secrets(text) == text


def test_the_name_of_a_file_has_no_query():
    assert file_name("https://bucket.example/a/x.las?X-Amz-Signature=s3cret") == "x.las"
    assert file_name("s3://bucket/a/x?.las/") == "x?.las"
    assert file_name("x.las") == "x.las"


def test_the_user_of_an_address_goes_into_a_header():
    assert split_credentials("https://h:8/p?q=1#f") == ("https://h:8/p?q=1#f", None)
    assert split_credentials("http://rig:p%40s%3As@[::1]:8/p?q=1") == ("http://[::1]:8/p?q=1", "Basic cmlnOnBAczpz")
    assert split_credentials("http://rig@h/") == ("http://h/", "Basic cmlnOg==")
