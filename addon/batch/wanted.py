"""What a run does with each of its files."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from ..core import Settings
from ..core.numerics.arrays import FloatArray

KINDS = {  # what can be transferred, as the operator names it
    "weights": "GROUPS",
    "uvs": "UVS",
    "colours": "COLOURS",
    "keys": "KEYS",
    "materials": "MATERIALS",
}
RESTS = {"none": "NONE", "t": "T", "a": "A", "reference": "REFERENCE"}  # the same for the pose in which a rig rests


@dataclass(frozen=True, eq=False)
class Wanted:
    """What a run does with each file.

    Attributes
    ----------
    output : Path
        Folder for the results.
    format : str
        Kind of file to write.
    settings : Settings
        Options of the method.
    shown : bool
        Whether to use meshes as modifiers, armatures and shape keys show them.
    frames : tuple of int
        Frames to compute; empty for the frame at which the file was saved.
    frame_keys : bool
        Whether to store the forms of all frames as shape keys in one .blend file.
    objects : tuple of str
        Names of the objects to compute; empty for all.
    together : bool
        Whether all objects of a file form one body.
    axes : (3, 3) ndarray of float or None
        Rotation from the axes of the scene to those of a text file, for row vectors; None for the usual ones of its
        kind.
    space : {'world', 'object'}
        Whether text files are written as the mesh lies in the scene, or in its own space.
    units : str or None
        Unit of length of text files, of `UNITS`; None for that of the scene.
    keep_rig : bool
        Whether results of other kinds than .blend have armatures, weights and keys, the form as one of these.
    colours : {'none', 'patches', 'adf'}
        Colours that are added to the result, in other kinds than .blend.
    measures : tuple of str
        Costly measures to take as well: 'hausdorff'.
    value : float
        Value of the shape key in a .blend file.
    trusted : bool
        Whether scripts and Python drivers in .blend files run.
    skip_existing : bool
        Skip files that already have a result.
    pose : str
        The mannequin that provides the pose, 'T' or 'A'; empty to use the pose of a reference.
    side : int
        Which way to match: -1 for the most likely, or its index.
    anyway : bool
        Whether to write a T-pose or an A-pose that is unlikely to be right.
    kinds : tuple of str
        Kinds of data to transfer, of `KINDS`.
    rest : str
        The pose in which a rig rests, of `RESTS`, as the operator names it.
    rigify : bool
        Whether Rigify's rig is generated.
    naming : str
        How the bones of the mannequin are called: one of `NAMINGS`.
    mark : str
        Distinguishes temporary files of this run from those of others.
    stages : bool
        Whether each worker shows its current stage.
    """

    output: Path
    format: str = "blend"
    settings: Settings = field(default_factory=Settings)
    shown: bool = False
    frames: tuple[int, ...] = ()
    frame_keys: bool = False
    objects: tuple[str, ...] = ()
    together: bool = False
    axes: FloatArray | None = None
    space: str = "world"
    units: str | None = None
    keep_rig: bool = False
    colours: str = "none"
    measures: tuple[str, ...] = ()
    value: float = 1.0
    trusted: bool = False
    skip_existing: bool = False
    pose: str = ""
    side: int = -1
    anyway: bool = False
    kinds: tuple[str, ...] = ()
    rest: str = "NONE"
    rigify: bool = False
    naming: str = "RIGIFY"
    mark: str = ""
    stages: bool = False

    @property
    def frames_of_files(self) -> list[tuple[int | None, ...]]:
        """Frames of each file that is written; None for the frame at which the file was saved."""
        if self.frame_keys:
            return [self.frames]
        return [(frame,) for frame in self.frames or (None,)]
