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


def icosphere(times):
    """Returns an icosahedron whose triangles are divided in four and projected onto the unit sphere `times` times."""
    g = (1 + 5**0.5) / 2
    corners = unit(np.array([[x * a, y * g, 0] for x in (-1, 1) for y in (-1, 1) for a in (1,)]
                            + [[0, x, y * g] for x in (-1, 1) for y in (-1, 1)] + [[y * g, 0, x] for x in (-1, 1) for y in (-1, 1)]))
    side = np.linalg.norm(corners[:, None] - corners, axis=-1)
    near = (side > 0) & (side < 1.01 * side[side > 0].min())
    triangles = np.array([corners[[i, j, k]] for i in range(12) for j in range(i) for k in range(j)
                          if near[i, j] and near[j, k] and near[k, i]])
    inwards = np.linalg.det(triangles) < 0
    triangles[inwards] = triangles[inwards][:, ::-1]
    for _ in range(times):
        a, b, c = np.moveaxis(triangles, 1, 0)
        ab, bc, ca = unit(a + b), unit(b + c), unit(c + a)
        triangles = np.concatenate([np.stack(three, axis=1) for three in
                                    ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    return triangles


def write_polygons(path, triangles):
    """Writes an OBJ or a binary PLY file, by the ending of its name."""
    corners, faces = np.unique(np.reshape(triangles, (-1, 3)), axis=0, return_inverse=True)
    faces = faces.reshape(-1, 3)
    if path.suffix == ".obj":
        path.write_text("".join(f"v {x:.17g} {y:.17g} {z:.17g}\n" for x, y, z in corners)
                        + "".join(f"f {a}//1 {b}//1 {c}//1\n" for a, b, c in faces + 1))
        return
    rows = np.zeros(len(faces), [("count", "u1"), ("corners", ">i4", 3)])
    rows["count"], rows["corners"] = 3, faces
    header = (f"ply\nformat binary_big_endian 1.0\nelement vertex {len(corners)}\nproperty double x\nproperty double y\n"
              f"property double z\nelement face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n")
    path.write_bytes(header.encode() + corners.astype(">f8").tobytes() + rows.tobytes())


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
