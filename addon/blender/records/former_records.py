"""Records as the first builds of version 0.1 wrote them: read as those of today."""

from __future__ import annotations

from typing import Any

FORMER_PROPERTY = "canonical_form"


def brought_up_to_date(data: dict[str, Any]) -> dict[str, Any]:
    """Turn the JSON object of a former record into that of today's.

    Parameters
    ----------
    data : dict
        A record. The first builds kept the names of what they wrote, without fingerprints.

    Returns
    -------
    dict
        The record as `Record.from_json` reads it. Nothing tells whether an item without a fingerprint was edited.

    Raises
    ------
    KeyError, TypeError
        If the data are not those of a record.

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
