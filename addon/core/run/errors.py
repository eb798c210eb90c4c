"""The named errors that the core raises."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from .messages import Message, kinds, message


class CanonicalFormError(Exception):
    """Base of every error of this project; its message tells the user what to do.

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
        """The values in the message, by name."""
        return getattr(self.args[0], "numbers", {})

    def about(self, what: str) -> CanonicalFormError:
        """Name the object that the error refers to, where there are several.

        `what`: its name.

        Examples
        --------
        >>> print(InvalidMeshError("no_faces").about("The other mesh"))
        The other mesh: The mesh has no faces. Choose a mesh with a surface.
        """
        said = message("about", what=what, error=self.args[0])
        return type(self)(Message(said, self.kind, {**self.numbers, **said.numbers}, said.sentence))


class InvalidFileError(CanonicalFormError):
    """A file does not hold a result of this package."""


class InvalidMeshError(CanonicalFormError):
    """No canonical form can be computed for the mesh as it is."""


class InvalidSettingsError(CanonicalFormError):
    """A setting has a value outside its range."""


class TooLargeError(CanonicalFormError):
    """The computation would need more memory than allowed."""


class SolverError(CanonicalFormError):
    """A numerical solver did not reach the accuracy that the method needs."""


class CancelledError(CanonicalFormError):
    """The caller asked the computation to stop."""

    def __init__(self, reason: str = "cancelled") -> None:
        super().__init__(reason)


@contextmanager
def errors_about(what: str) -> Iterator[None]:
    """Let the errors of a computation name what they are about; a cancelled run is about nothing.

    `what`: its name.

    Examples
    --------
    >>> with errors_about("The other mesh"):
    ...     raise InvalidMeshError("no_faces")
    Traceback (most recent call last):
    addon.core.run.errors.InvalidMeshError: The other mesh: The mesh has no faces. Choose a mesh with a surface.
    """
    try:
        yield
    except CancelledError:
        raise
    except CanonicalFormError as error:
        raise error.about(what) from error
