#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "grin/media/geometry/vec3.h"

namespace flatspeckle::grin {

/// Voxels with labels. Voxel (i, j, k) extends from origin + (i, j, k) * spacing to origin + (i +
/// 1, j + 1, k + 1) * spacing; k varies fastest.
struct LabelVolume {
  static constexpr int most_labels = 4096;
  static constexpr double most_voxels = 1 << 30;

  Vec3 origin = Vec3::Zero(), spacing = Vec3::Ones();
  std::array<int, 3> voxels{};
  std::vector<std::uint16_t> labels = {};

  Vec3 end() const { return origin + spacing.cwiseProduct(Vec3(voxels[0], voxels[1], voxels[2])); }
  std::size_t number(int i, int j, int k) const {
    return (static_cast<std::size_t>(i) * voxels[1] + j) * voxels[2] + k;
  }
  /// Returns the label at x; 0 outside of the voxels.
  int at(const Vec3& x) const {
    std::array<int, 3> voxel;
    for (int a = 0; a < 3; ++a) {
      const double place = (x[a] - origin[a]) / spacing[a];
      if (!(place >= 0 && place < voxels[a])) return 0;
      voxel[a] = static_cast<int>(place);
    }
    return labels[number(voxel[0], voxel[1], voxel[2])];
  }
};

/// Throws InputError for fewer than one voxel along an axis, too many voxels, or a spacing that is
/// not positive.
void check(const LabelVolume& volume);

/// Reads labels from a file: the dataset labels[x, y, z] of an HDF5 file, with its attributes
/// origin (corner of the first voxel) and spacing; a NIfTI-1 file (.nii) [cox2004]; or the shapes
/// of an MCX scene (.json). Throws InputError.
LabelVolume read_labels(const std::filesystem::path& path);

/// Reads a NIfTI-1 file that is not compressed. Its first voxel begins at 0 0 0.
LabelVolume read_nifti(const std::filesystem::path& path);

}  // namespace flatspeckle::grin
