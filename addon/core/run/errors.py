"""The named errors that the core raises."""

from __future__ import annotations

from typing import Any

from .messages import Message, kinds, message


class CanonicalFormError(Exception):
    """Base of every error of this project; its text tells the user what to do.

    Parameters
    ----------
    reason : str
        A kind of message, one of `addon.core.run.messages.kinds()`, or a sentence.
    **numbers
        Values for the sentence of that kind.

    Examples
    --------
    >>> from addon.core import InvalidMeshError, canonical_form
    >>> try:
    ...     canonical_form([[0, 0, 0]], [])
    ... except InvalidMeshError as error:
    ...     print(error.kind, "|", error)
    no_faces | The mesh has no faces. Choose a mesh with a surface.
    """

    def __init__(self, reason: str = "", /, **numbers: Any) -> None:
        super().__init__(message(reason, **numbers) if reason in kinds() else reason)

    @property
    def kind(self) -> str:
        """What went wrong, one of `addon.core.run.messages.kinds()`; empty for an error of an outer layer."""
        return getattr(self.args[0], "kind", "")

    @property
    def numbers(self) -> dict[str, Any]:
        """What the text tells beside its kind."""
        return getattr(self.args[0], "numbers", {})

    def about(self, what: str) -> CanonicalFormError:
        """Say of what the error tells, where there are several.

        Parameters
        ----------
        what : str
            Its name.

        Returns
        -------
        CanonicalFormError
            The same error, whose text begins with that name.

        Examples
        --------
        >>> print(InvalidMeshError("no_faces").about("The other mesh"))
        The other mesh: The mesh has no faces. Choose a mesh with a surface.
        """
        said = message("about", what=what, error=self.args[0])
        return type(self)(Message(said, self.kind, {**self.numbers, **said.numbers}, said.sentence))


class InvalidMeshError(CanonicalFormError):
    """The mesh cannot be given a canonical form as it stands."""


class InvalidSettingsError(CanonicalFormError):
    """A setting has a value outside its range."""


class TooLargeError(CanonicalFormError):
    """The computation would need more memory than it is allowed."""


class SolverError(CanonicalFormError):
    """A numerical solver did not reach the accuracy that the method needs."""


class CancelledError(CanonicalFormError):
    """The caller asked the computation to stop."""

    def __init__(self, reason: str = "cancelled") -> None:
        super().__init__(reason)
