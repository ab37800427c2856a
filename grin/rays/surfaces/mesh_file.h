#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "grin/rays/surfaces/triangle_mesh.h"

namespace flatspeckle::grin {

/// Reads the faces of an STL, OBJ or PLY file, binary or text, and makes a closed_mesh() of them.
/// The ending of the name, .obj or .ply, selects the format; all other files are STL. Polygons are
/// divided into triangles; normals, colours and all else are ignored. Every InputError names the
/// key and the file.
TriangleMesh read_mesh(const std::string& key, const std::filesystem::path& path,
                       std::optional<double> weld = {});

// The following functions return the three corners of each triangle of a file's content. They
// throw InputError.

std::vector<Vec3> corners_of_stl(const std::string& bytes);
std::vector<Vec3> corners_of_obj(const std::string& bytes);
std::vector<Vec3> corners_of_ply(const std::string& bytes);

/// Returns a note for error messages if an STL file continues after the triangles that its header
/// counts.
std::string left_out_of_stl(const std::string& bytes);

/// Adds the triangles of a polygon, given by indices of corners. Throws InputError for a polygon of
/// fewer than three corners and for an index without a corner.
void add_polygon(const std::vector<Vec3>& corners, const std::vector<long>& polygon,
                 std::vector<Vec3>& triangles);

}  // namespace flatspeckle::grin
