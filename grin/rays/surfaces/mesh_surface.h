#pragma once

#include <string>

#include "core/error.h"
#include "grin/rays/surfaces/curved_mesh.h"
#include "grin/rays/surfaces/level_surface.h"

namespace flatspeckle::grin {

/// Error of a mesh whose parts overlap, lie inside one another or are turned inside out.
struct OverlapError : InputError {
  using InputError::InputError;
};

/// Returns a smooth surface that approximates a mesh. It consists of cubic B-splines, computed from
/// the signed distances from the mesh at the nodes of a grid. Planes are exact, and the error of
/// spheres is proportional to the fourth power of the spacing. Edges are rounded over one spacing;
/// next to an edge, faces swell by 1/20 of the spacing. Throws an InputError that names `key`, the
/// key of the spacing, if the spacing is so large that the volume would change by 5 %, or so small
/// that the grid would have more than 2e7 nodes. Throws OverlapError for a mesh whose parts
/// overlap.
LevelSurface mesh_surface(const TriangleMesh& mesh, double spacing, const std::string& key);

/// Deviations of a smooth surface from the mesh that it approximates.
struct MeshFit {
  double volume_change;     ///< relative change of the volume
  double area_change;       ///< relative change of the area
  double normal_deviation;  ///< rms angle between the normals, except close to sharp edges, radians
  double sharp_share;       ///< share of the area that is within three spacings of sharp edges
};

MeshFit fit_of(const LevelSurface& surface, const CurvedMesh& mesh);

/// Returns a smooth surface with a grid spacing of 1/64 of the longest side of the mesh. If normals
/// then deviate by more than 0.01 (rms), the area by 5 % or the volume by 1 %, uses 1/128 or 1/256.
LevelSurface mesh_surface(const CurvedMesh& mesh, const std::string& key);

/// Largest spacing that mesh_surface() chooses for a mesh.
double first_spacing(const TriangleMesh& mesh);

/// Returns a note for the user on how a smooth surface differs from the mesh, with a warning if
/// normals or area deviate by more than the limits of mesh_surface().
std::string note_on(const std::string& key, const LevelSurface& surface, const CurvedMesh& mesh);

}  // namespace flatspeckle::grin
