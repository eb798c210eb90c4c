"""The meshes of the experiments: folders of .obj poses, rigged characters of .glb and .blend files, and generated ones.

A folder of data has a subfolder of .obj files for each body, one a pose, with the same vertex order in all of them, and
rigged files in its subfolder ``creatures``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from addon.core.assembly.pieces import connected_pieces
from addon.core.mesh.geometry import surface_area
from addon.evaluation.tables import mean_apart
from tests.meshes.shapes import Mesh, poses_of

HUMANS = ("man", "woman")  # folders of two-legged bodies
ARMS, LEGS = ("arm", "front_leg_upper", "front_leg_lower"), ("thigh", "calf", "back_leg_upper", "back_leg_lower")
CLIPS = 10  # poses of a rigged file, at most


class Poses(NamedTuple):
    """Poses of one body: their names, their vertices (n, 3), and the triangles (m, 3) that all of them share."""

    names: list[str]
    vertices: list[np.ndarray]
    faces: np.ndarray


@dataclass(frozen=True)
class Body:
    """One body in its poses, read when they are first asked for."""

    name: str
    load: Callable[[], Poses]
    files: tuple[Path, ...] = ()  # what the poses are read from: kept results depend on it

    @cached_property
    def poses(self) -> Poses:
        """The poses."""
        return self.load()

    @property
    def first(self) -> Mesh:
        """The mesh in its first pose."""
        return self.poses.vertices[0], self.poses.faces

    def some(self, count: int) -> list[np.ndarray]:
        """Return the vertices of the first poses."""
        return self.poses.vertices[:count]


@dataclass(frozen=True)
class Collection(Body):
    """Bodies that are measured together, such as the classes of an evaluation."""

    bodies: tuple[Body, ...] = ()


def together(bodies: Sequence[Body]) -> list[Body]:
    """Return one collection of bodies, or nothing if there are none."""

    def no_poses() -> Poses:
        raise TypeError("A collection has no poses: take those of its bodies.")

    files = tuple(file for body in bodies for file in body.files)
    return [Collection(", ".join(body.name for body in bodies), no_poses, files, tuple(bodies))] if bodies else []


def chosen(bodies: Sequence[Body], names: Sequence[str]) -> list[Body]:
    """Return the bodies of some names, also within collections; all of them without names."""
    if not names:
        return list(bodies)
    inner = [each for body in bodies if isinstance(body, Collection) for each in body.bodies if each.name in names]
    return [body for body in bodies if body.name in names] + together(inner)


def folders(data: Path | None) -> list[Body]:
    """Return a body for each subfolder with .obj files, its rest pose first."""
    inner = sorted(path for path in data.iterdir() if path.is_dir()) if data else []
    return [Body(each.name, partial(_read_folder, each), files) for each in inner if (files := _sorted(each, "*.obj"))]


def humans(data: Path | None) -> list[Body]:
    """Return the two-legged bodies among the folders."""
    return [body for body in folders(data) if body.name in HUMANS]


def finest_first(data: Path | None) -> list[Body]:
    """Return the bodies of the folders, that with the most vertices first."""
    return sorted(folders(data), key=lambda body: -len(body.first[0]))


def creatures(data: Path | None) -> list[Body]:
    """Return a body for each rigged file, with all its objects as one mesh; reading it needs bpy."""
    files = [*_sorted(data / "creatures", "*.glb"), *_sorted(data / "creatures", "*.blend")] if data else []
    return [Body(file.stem, partial(read_rigged, file), (file,)) for file in files]


def largest_pieces(data: Path | None) -> list[Body]:
    """Return the largest connected piece of each rigged file."""
    return [Body(body.name, partial(_largest, body), body.files) for body in creatures(data)]


def generated(**meshes: Callable[[], Mesh]) -> Callable[[Path | None], list[Body]]:
    """Return a set of meshes that are made by functions; no data are read."""

    def made(name: str) -> Poses:
        vertices, faces = meshes[name]()
        return Poses([""], [vertices], faces)

    return lambda data: [Body(name, partial(made, name)) for name in meshes]


def pose_ratio(poses: list[np.ndarray], forms: list[np.ndarray], faces: np.ndarray, mirror: bool = False) -> float:
    """Return how far forms are apart over how far their poses are; all scaled to unit area."""
    return apart(forms, faces, mirror) / apart(poses, faces)


def apart(shapes: list[np.ndarray], faces: np.ndarray, mirror: bool = False) -> float:
    """Return the mean distance of shapes of one body after rigid alignment, in sqrt(area); NaN for a single one."""
    if len(shapes) < 2:
        return float("nan")
    return mean_apart([shape / np.sqrt(surface_area(shape, faces)) for shape in shapes], mirror)


def _sorted(folder: Path, pattern: str) -> tuple[Path, ...]:
    return tuple(sorted(folder.glob(pattern)))


def _read_folder(folder: Path) -> Poses:
    names, vertices, faces = zip(*poses_of(folder), strict=True)
    for name, other in zip(names, faces, strict=True):
        if not np.array_equal(other, faces[0]):
            raise ValueError(f"{name}.obj and {names[0]}.obj in {folder} have other triangles: one folder per mesh.")
    return Poses(list(names), list(vertices), faces[0])


def _largest(body: Body) -> Poses:
    names, vertices, faces = body.poses
    piece = max(connected_pieces(vertices[0], faces).pieces, key=lambda each: len(each.vertices))
    return Poses(names, [pose[piece.vertices] for pose in vertices], piece.faces)


def read_rigged(file: Path, count: int = CLIPS) -> Poses:
    """Read a rigged file: its rest pose, then the middles of its clips, or random turns of its bones if it has none."""
    rig, objects = open_rigged(file)
    vertices: list[np.ndarray] = []
    for _ in rig_poses(rig, count):
        pose, faces = shown(objects)
        if not any(np.allclose(pose, other) for other in vertices):
            vertices.append(pose)
    return Poses(["rest", *(f"pose {number}" for number in range(1, len(vertices)))], vertices, faces)


def open_rigged(file: Path) -> tuple[Any, list[Any]]:
    """Open a file in Blender; return its armature and the meshes under it, by name."""
    import bpy

    bpy.ops.wm.read_factory_settings(use_empty=True)
    if file.suffix == ".blend":
        bpy.ops.wm.open_mainfile(filepath=str(file))
    else:
        bpy.ops.import_scene.gltf(filepath=str(file), merge_vertices=True)
    rig = next(obj for obj in bpy.data.objects if obj.type == "ARMATURE")
    meshes = (obj for obj in bpy.data.objects if obj.parent is rig and obj.type == "MESH")
    return rig, sorted(meshes, key=lambda obj: obj.name)


def rig_poses(rig: Any, count: int) -> Iterator[int]:
    """Pose a rig: at rest, then by its clips in turn, or with arms and legs turned at random with a fixed seed."""
    import bpy

    rng = np.random.default_rng(1)
    clips = sorted(bpy.data.actions, key=lambda action: (not action.name.startswith("Rest"), action.name))
    for number in range(count):
        if clips:
            for track in list(rig.animation_data.nla_tracks):
                rig.animation_data.nla_tracks.remove(track)
            action = rig.animation_data.action = clips[number % len(clips)]
            if getattr(action, "slots", None):
                rig.animation_data.action_slot = action.slots[0]
            bpy.context.scene.frame_set(round(sum(action.frame_range) / 2))
        for bone in () if clips else rig.pose.bones:
            bone.rotation_mode, name = "XYZ", bone.name.lower()
            most = 45 if any(part in name for part in ARMS) else 35 if name.startswith(LEGS) else 0
            bone.rotation_euler = np.radians(rng.uniform(-most, most, 3)) * bool(number)
        bpy.context.view_layer.update()
        yield number


def shown(objects: list[Any]) -> Mesh:
    """Return objects as one mesh of triangles, as Blender shows them, in the space of the scene."""
    import bpy

    graph = bpy.context.evaluated_depsgraph_get()
    vertices, faces, count = [], [], 0
    for obj in objects:
        evaluated = obj.evaluated_get(graph)
        mesh = evaluated.to_mesh()
        mesh.calc_loop_triangles()
        own, corners = np.empty(3 * len(mesh.vertices)), np.empty(3 * len(mesh.loop_triangles), dtype=np.int32)
        mesh.vertices.foreach_get("co", own)
        mesh.loop_triangles.foreach_get("vertices", corners)
        matrix = np.array(obj.matrix_world)
        vertices.append(own.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3])
        faces.append(corners.reshape(-1, 3).astype(np.int64) + count)
        count += len(vertices[-1])
        evaluated.to_mesh_clear()
    return np.concatenate(vertices), np.concatenate(faces)
