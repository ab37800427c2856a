#pragma once

#include <string>

#include "grin/rays/surfaces/level_surface.h"
#include "grin/rays/surfaces/triangle_mesh.h"

namespace flatspeckle::grin {

/// A smooth surface in place of a mesh, of cubic B-splines of the mesh's signed distances at the
/// nodes of a grid: planes stay as they are, spheres are off by the fourth power of the spacing,
/// and edges are rounded over one spacing, beside which faces swell by a twentieth of it. Throws
/// InputError, naming `key` of the spacing, where that is so large that 5 % of the volume would be
/// lost or won, or so small that the grid would have more than 2e7 nodes.
LevelSurface mesh_surface(const TriangleMesh& mesh, double spacing, const std::string& key);

/// The same with a spacing of 1/64 of the longest side, or 1/128 or 1/256 where it takes that for
/// the volume to be right to 1 %, as of thin plates.
LevelSurface mesh_surface(const TriangleMesh& mesh, const std::string& key);

}  // namespace flatspeckle::grin
