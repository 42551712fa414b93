"""What is not installed with the package, and how to get it: `advice`."""

# format: packages of each extra, as pyproject.toml names them; tests/numeric/test_extras.py compares
EXTRAS = {
    "av": "av>=15",
    "gym": "gymnasium>=1.0",
    "record": "mcap>=1.6",
    "ros": "rosbags>=0.11 mcap>=1.6",
    "serial": "pyserial>=3.5",
    "web": "starlette>=0.46 uvicorn>=0.34 websockets>=14 segno>=1.6",
}


def advice(extra: str) -> str:
    """Return what to type to get the packages of an extra: it works wherever `matchset` came from.

    Parameters
    ----------
    extra : str
        A name of `EXTRAS`.

    Returns
    -------
    str
        Such as ``pip install 'mcap>=1.6'``.
    """
    return "pip install " + " ".join(f"'{package}'" for package in EXTRAS[extra].split())
