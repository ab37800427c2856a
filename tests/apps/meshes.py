"""Meshes of triangles [triangle][3][x, y, z], anticlockwise seen from outside, and their STL files."""

import numpy as np


def unit(x):
    return x / np.linalg.norm(x, axis=-1, keepdims=True)


def ball(times=5):
    """Returns an octahedron whose triangles are divided in four and projected onto the unit sphere `times` times."""
    x, y, z = np.eye(3)
    upper = np.array([[x, y, z], [y, -x, z], [-x, -y, z], [-y, x, z]])
    triangles = np.concatenate([upper, upper[:, ::-1] * [1, 1, -1]])
    for _ in range(times):
        a, b, c = np.moveaxis(triangles, 1, 0)
        ab, bc, ca = unit(a + b), unit(b + c), unit(c + a)
        triangles = np.concatenate([np.stack(corners, axis=1) for corners in
                                    ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    return triangles


def volume(triangles):
    return np.linalg.det(triangles).sum() / 6


def write_stl(path, triangles, text=False):
    triangles = np.asarray(triangles, dtype=np.float32)
    if text:
        facets = ("facet normal 0 0 0\nouter loop\n"
                  + "".join(f"vertex {x:.9g} {y:.9g} {z:.9g}\n" for x, y, z in triangle)
                  + "endloop\nendfacet\n" for triangle in triangles)
        path.write_text("solid thing\n" + "".join(facets) + "endsolid thing\n")
        return
    rows = np.zeros(len(triangles), [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("spare", "<u2")])
    rows["corners"] = triangles
    path.write_bytes(b"solid binary".ljust(80) + np.uint32(len(rows)).tobytes() + rows.tobytes())
