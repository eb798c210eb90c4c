"""The named errors that the core raises."""


class CanonicalFormError(Exception):
    """Base of every error of this project; its text tells the user what to do."""


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

    def __init__(self, message: str = "Cancelled; nothing was changed.") -> None:
        super().__init__(message)
