"""The certificate of https, looked at before the server begins: what is wrong with it, by the name of its file."""

from __future__ import annotations

import ssl
from pathlib import Path

BEGIN_CERTIFICATE, KEY_WORD = "-----BEGIN CERTIFICATE-----", "PRIVATE KEY-----"
LOCKED = ("BEGIN ENCRYPTED PRIVATE KEY", "Proc-Type: 4,ENCRYPTED")


class BadCertificate(OSError):
    """The text says which file it is, what is wrong with it and what helps."""


def require_certificate(certificate: Path, key: Path) -> None:
    """Raises BadCertificate where a server could not begin https with these two files."""
    of_certificate = _text(certificate, "the certificate")
    of_key = _text(key, "the key")
    if BEGIN_CERTIFICATE not in of_certificate:
        swapped = KEY_WORD in of_certificate and BEGIN_CERTIFICATE in of_key
        raise BadCertificate(
            f"{certificate} is a key, and {key} a certificate: tls_cert and tls_key are the wrong way round"
            if swapped
            else f"the certificate {certificate} has no {BEGIN_CERTIFICATE}: it is to be PEM;"
            f" of DER one makes that by: openssl x509 -inform der -in {certificate} -out cert.pem"
        )
    if KEY_WORD not in of_key:
        raise BadCertificate(
            f"the key {key} has no -----BEGIN PRIVATE KEY-----: it is to be PEM, and the one of {certificate}"
        )
    if any(word in of_key for word in LOCKED):
        raise BadCertificate(
            f"the key {key} is locked with a passphrase, which nobody can type when the server starts;"
            f" unlock it: openssl pkey -in {key} -out key.pem"
        )
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    try:
        context.load_verify_locations(cadata=of_certificate)
    except (ssl.SSLError, ValueError) as error:
        raise BadCertificate(f"the certificate {certificate} cannot be read: it is damaged{_why(error)}") from error
    try:
        context.load_cert_chain(certificate, key)
    except ssl.SSLError as error:
        if error.reason == "KEY_VALUES_MISMATCH":
            raise BadCertificate(f"{key} is not the key of the certificate {certificate}") from error
        if error.reason in ("EE_KEY_TOO_SMALL", "CA_MD_TOO_WEAK", "CA_KEY_TOO_SMALL"):
            raise BadCertificate(
                f"the certificate {certificate} is too weak for browsers of today{_why(error)}: make one with a key"
                " of 2048 bits or more, and SHA-256"
            ) from error
        raise BadCertificate(f"the key {key} cannot be read: it is damaged{_why(error)}") from error


def _text(path: Path, what: str) -> str:
    try:
        return path.read_text(encoding="ascii", errors="replace")
    except OSError as error:
        raise BadCertificate(f"{what} {path} cannot be read: {error.strerror or error}") from error


def _why(error: Exception) -> str:
    """OpenSSL's reason in brackets, where it has one that says anything."""
    reason = getattr(error, "reason", None)
    return f" ({str(reason).replace('_', ' ').lower()})" if reason else ""
