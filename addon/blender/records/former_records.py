"""Records written by the first builds of version 0.1, converted to the current format."""

from __future__ import annotations

from typing import Any

FORMER_PROPERTY = "canonical_form"


def brought_up_to_date(data: dict[str, Any]) -> dict[str, Any]:
    """Convert the JSON object of an earlier record to the current format.

    Parameters
    ----------
    data : dict
        A record. The first builds stored the names of what they wrote, without fingerprints.

    Returns
    -------
    dict
        The record as `Record.from_json` reads it. An item without a fingerprint may have been edited; this is unknown.

    Raises
    ------
    KeyError, TypeError
        If the data is not that of a record.

    Examples
    --------
    >>> brought_up_to_date({"shape_key": "Canonical Form", "groups": ["Patch 1"], "colours": []})["groups"]
    {'Patch 1': None}
    """
    if "shape_key" not in data:
        return data
    return {
        **data,
        "key": {data["shape_key"]: None},
        "groups": dict.fromkeys(data["groups"]),
        "colours": dict.fromkeys(data["colours"]),
    }
