"""How results of a run show themselves."""

from __future__ import annotations

from .messages import Message


class Summarised:
    """Results whose representation shows array shapes.

    Attributes
    ----------
    warnings : list of Message
        Sentences for the user.
    """

    warnings: list[Message]

    def __repr__(self) -> str:
        sizes = [f"{name} {value.shape}" for name, value in vars(self).items() if hasattr(value, "shape")]
        return f"<{type(self).__name__}: {', '.join(sizes)}, {len(self.warnings)} warning(s)>"
