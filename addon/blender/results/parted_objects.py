"""Objects whose mesh is parted: contacts cut out and closed by caps, with everything that the mesh carries."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import bmesh
import bpy
import numpy as np

from ...core.fused.on_given import given_of
from ...core.mesh.tables import rows_in

if TYPE_CHECKING:
    from ...core.fused.on_given import Parted
    from ...core.numerics.arrays import BoolArray, IntArray

_NORMALS = "canonical_form_normals"  # attribute for a while


class Sources(NamedTuple):
    """What the vertices of a parted object are.

    Attributes
    ----------
    rows : (n',) ndarray of int
        The vertex of the parted mesh; -1 for those of no face.
    given : (n',) ndarray of int
        The vertex of the mesh before; for those of caps the nearest one.
    """

    rows: IntArray
    given: IntArray


def part_object(obj: bpy.types.Object, parted: Parted, faces: IntArray) -> Sources:
    """Part the mesh of an object.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, in Object Mode, without shape keys; no other has its mesh.
    parted : Parted
        What was computed on the mesh when it was parted.
    faces : (m, 3) ndarray of int
        The triangles of the mesh before, as they were repaired.

    Returns
    -------
    Sources
        What its vertices are now.
    """
    normals = _keep_normals(obj.data)
    part = _Parting(obj.data, parted, faces)
    try:
        found = part.done()
    finally:
        part.bm.free()
    if normals:
        _set_normals(obj.data)
    return found


class _Parting:
    """The parting of one mesh, which its steps share."""

    def __init__(self, mesh: bpy.types.Mesh, parted: Parted, faces: IntArray) -> None:
        self.mesh, self.made = mesh, parted.mesh
        self.home = self.made.copies(len(parted.representative))[parted.representative]  # (n,) -1: all was taken out
        self.loops, self.vertices, self.polygons = _triangles(mesh)  # (t, 3), (t, 3), (t,)
        self.rows = self._rows_of_corners(parted.representative[self.vertices], faces)  # (t, 3)
        self.bm = bmesh.new()
        self.bm.from_mesh(mesh)
        self.given = list(self.bm.verts)
        self.number = {vert: number for number, vert in enumerate(self.given)}  # lasts, unlike an index
        self.old: set[bmesh.types.BMFace] = set()  # faces to be removed
        self.normals = self.bm.loops.layers.float_vector.get(_NORMALS)
        self.vert_of: dict[int, bmesh.types.BMVert] = {}  # by row
        self.copies: dict[tuple[int, int], bmesh.types.BMVert] = {}  # by vertex as given and row
        self.made_from: dict[bmesh.types.BMVert, tuple[int, int]] = {}  # of new vertices: row, and vertex as given

    def done(self) -> Sources:
        """Part the mesh; return what its vertices are."""
        whole, own_faces = self._whole_polygons(), list(self.bm.faces)
        moved = ((self.rows != self.home[self.vertices]) | (self.rows < 0)).any(axis=1)
        changed = np.flatnonzero(np.bincount(self.polygons, moved, len(own_faces)))
        begin = np.searchsorted(self.polygons, np.arange(len(own_faces) + 1))  # triangles are listed by polygon
        for number in changed.tolist():
            face = own_faces[number]
            loops = {loop.index: loop for loop in face.loops}
            own = slice(begin[number], begin[number + 1])
            corners, rows = self.loops[own].tolist(), self.rows[own].tolist()
            if whole[number]:
                row_at = dict(zip(self.loops[own].ravel().tolist(), self.rows[own].ravel().tolist(), strict=True))
                corners, rows = [list(loops)], [[row_at[loop] for loop in loops]]
            for each, at in zip(corners, rows, strict=True):
                if min(at) >= 0:
                    self._add(face, [loops[loop] for loop in each], at, whole=bool(whole[number]))
            self.old.add(face)
        self._close()
        touched = {vert for face in self.old for vert in face.verts}
        bmesh.ops.delete(self.bm, geom=list(self.old), context="FACES")
        bare = [vert for vert in touched if vert.is_valid and not vert.link_edges]  # all its faces have copies
        bmesh.ops.delete(self.bm, geom=bare, context="VERTS")
        return self._written()

    def _rows_of_corners(self, corners: IntArray, faces: IntArray) -> IntArray:
        """Find the rows of triangles' corners, (t, 3); -1 where one was taken out. `corners` (t, 3)."""
        made = self.made.faces[: self.made.first_of_caps]
        number = _numbers_in(corners, self.made.origin[made])
        rows = self.home[self.vertices]
        rows[(number < 0) & (_numbers_in(corners, faces) >= 0)] = -1  # those in neither were repaired, and stay
        there = np.flatnonzero(number >= 0)
        own = made[number[there]]  # (s, 3), in an order of its own
        same = self.made.origin[own][:, None, :] == corners[there][:, :, None]
        rows[there] = np.take_along_axis(own, same.argmax(axis=2), axis=1)
        return rows

    def _whole_polygons(self) -> BoolArray:
        """Tell which polygons keep all triangles, each corner with one row in all of them."""
        count = len(self.mesh.loops)
        high, low = np.full(count, -1), np.full(count, len(self.made.vertices))
        np.maximum.at(high, self.loops, self.rows)
        np.minimum.at(low, self.loops, self.rows)
        broken = (self.rows < 0).any(axis=1) | (high[self.loops] != low[self.loops]).any(axis=1)
        return np.bincount(self.polygons, broken, len(self.mesh.polygons)) == 0

    def _vert(self, vertex: int, row: int) -> bmesh.types.BMVert:
        """Return the vertex of a row: that as given if it is the first of its rows, else a copy."""
        if row == self.home[vertex]:
            found = self.given[vertex]
        elif (vertex, row) in self.copies:
            found = self.copies[vertex, row]
        else:
            found = self.copies[vertex, row] = self.bm.verts.new(self.given[vertex].co, self.given[vertex])
            self.made_from[found] = row, vertex
        self.vert_of.setdefault(row, found)
        return found

    def _add(self, like: bmesh.types.BMFace, loops: list[bmesh.types.BMLoop], rows: list[int], *, whole: bool) -> None:
        """Add a face like another one, with the data of its corners; of the whole of it, of its edges, too."""
        verts = [self._vert(self.number[loop.vert], row) for loop, row in zip(loops, rows, strict=True)]
        if self.bm.faces.get(verts) is None:
            face = self.bm.faces.new(verts, like)
            for own, loop in zip(face.loops, loops, strict=True):
                if whole and own.edge != loop.edge:
                    own.edge.copy_from(loop.edge)
                own.copy_from(loop)  # Python's corner is not valid after that

    def _close(self) -> None:
        """Add the caps, with the data of the faces at their rims."""
        caps, beside = self.made.faces[self.made.first_of_caps :], given_of(self.made)
        for row in np.unique(caps).tolist():
            if row in self.vert_of:
                continue
            if self.made.origin[row] >= 0:
                self._vert(int(beside[row]), row)
                continue
            like = self.given[int(beside[row])]
            self.vert_of[row] = self.bm.verts.new(like.co, like)
            self.made_from[self.vert_of[row]] = row, int(beside[row])
        for corners in caps.tolist():
            verts = [self.vert_of[row] for row in corners]
            data = [_corner_at(vert, self.given[int(beside[row])]) for vert, row in zip(verts, corners, strict=True)]
            there = self.bm.faces.get(verts)
            if there in self.old:  # what was taken out is the cap
                self.old.discard(there)
                if _begins_with(there, verts[0]).link_loop_next.vert != verts[1]:
                    there.normal_flip()
            elif there is None:
                face = self.bm.faces.new(verts, data[0].face)
                for own, loop in zip(face.loops, data, strict=True):
                    own.copy_from(loop)
                for own in face.loops if self.normals is not None else ():
                    own[self.normals] = (0.0, 0.0, 0.0)  # as the surface has it

    def _written(self) -> Sources:
        """Write the mesh back; return what its vertices are."""
        made = [self.made_from[vert] if vert in self.made_from else (-1, self.number[vert]) for vert in self.bm.verts]
        rows, given = np.array(made, dtype=np.int64).T
        rows = np.where(rows < 0, self.home[given], rows)
        self.bm.to_mesh(self.mesh)
        places = np.empty((len(rows), 3), dtype=np.float32)
        self.mesh.vertices.foreach_get("co", places.ravel())
        places[rows >= 0] = self.made.vertices[rows[rows >= 0]]
        self.mesh.vertices.foreach_set("co", places.ravel())
        self.mesh.update()
        return Sources(rows, given)


def _keep_normals(mesh: bpy.types.Mesh) -> bool:
    """Keep custom normals as vectors, since they are stored relative to the surface; return whether there are any."""
    if not mesh.has_custom_normals:
        return False
    vectors = np.empty(3 * len(mesh.loops), dtype=np.float32)
    mesh.corner_normals.foreach_get("vector", vectors)
    mesh.attributes.new(_NORMALS, "FLOAT_VECTOR", "CORNER").data.foreach_set("vector", vectors)
    return True


def _set_normals(mesh: bpy.types.Mesh) -> None:
    """Set custom normals to vectors that were kept; those of zero are as the surface has them."""
    vectors = np.empty((len(mesh.loops), 3), dtype=np.float32)
    mesh.attributes[_NORMALS].data.foreach_get("vector", vectors.ravel())
    mesh.attributes.remove(mesh.attributes[_NORMALS])
    mesh.normals_split_custom_set(vectors.tolist())


def _begins_with(face: bmesh.types.BMFace, vert: bmesh.types.BMVert) -> bmesh.types.BMLoop:
    """Return the corner of a face at one of its vertices."""
    return next(loop for loop in face.loops if loop.vert == vert)


def _triangles(mesh: bpy.types.Mesh) -> tuple[IntArray, IntArray, IntArray]:
    """Return loops and vertices of the triangles of a mesh, (t, 3) both, and their polygons, (t,)."""
    mesh.calc_loop_triangles()
    found = []
    for name, width in (("loops", 3), ("vertices", 3), ("polygon_index", 1)):
        values = np.empty(width * len(mesh.loop_triangles), dtype=np.int32)
        mesh.loop_triangles.foreach_get(name, values)
        found.append(values.astype(np.int64).reshape(-1, 3) if width == 3 else values.astype(np.int64))
    loops, vertices, polygons = found
    return loops, vertices, polygons


def _numbers_in(triangles: IntArray, table: IntArray) -> IntArray:
    """Look triangles up in a table, whatever corner they begin at; gives (t,), -1 for those that are not in it."""
    return rows_in(np.sort(triangles, axis=1), np.sort(table, axis=1))


def _corner_at(*verts: bmesh.types.BMVert) -> bmesh.types.BMLoop:
    """Return a corner at the first of some vertices that has a face."""
    return next(loop for vert in verts for loop in vert.link_loops)
