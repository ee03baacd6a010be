"""Keep the secrets of addresses out of texts: users, passwords, and signatures of presigned addresses.

https://rig:s3@host/x?X-Amz-Signature=ab  ->  https://...@host/x?...
"""

from __future__ import annotations

import base64
import re
from urllib.parse import unquote, urlsplit, urlunsplit

USER = re.compile(r"(?<=://)[^\s/?#'\"<>]*@")
SCHEMES = "https?|s3a?|gs|gcs|abfss?|adl|az|wasbs?|ftps?|sftp"
QUERY = re.compile(rf"(\b(?:{SCHEMES})://[^\s?'\"<>]*\?)[^\s'\"<>]*[^\s'\"<>:]", re.IGNORECASE)
FIELD = re.compile(
    r"\b((?:X-(?:Amz|Goog)-[\w-]+|AWSAccessKeyId|AccountKey|SharedAccessSignature|Signature|sig|token|password|secret)=)"
    r"[^\s&;'\"<>]*[^\s&;'\"<>:]",
    re.IGNORECASE,
)


def without_secrets(text: str) -> str:
    """Return a text in which each address has ``...`` in place of its user and password, and of its query."""
    return FIELD.sub(r"\1...", QUERY.sub(r"\1...", USER.sub("...@", text)))


def file_name(address: str) -> str:
    """Return the name of the file at an address, without its folders and, of a web address, without its query."""
    path = address.partition("?")[0] if address.startswith(("https://", "http://")) else address
    return path.rstrip("/").rpartition("/")[2]


def split_credentials(address: str) -> tuple[str, str | None]:
    """Return a web address without its user and password, and the value of the header Authorization for these.

    The value is None if the address has no user. A host is asked for by its name alone.
    """
    parts = urlsplit(address)
    user, at, host = parts.netloc.rpartition("@")
    if not at:
        return address, None
    name, _, password = user.partition(":")
    credentials = base64.b64encode(f"{unquote(name)}:{unquote(password)}".encode()).decode()
    return urlunsplit(parts._replace(netloc=host)), f"Basic {credentials}"
