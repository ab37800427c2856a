#pragma once

#include <memory>
#include <vector>

#include "grin/media/labels/label_volume.h"
#include "grin/media/scattering/scattering_medium.h"

namespace flatspeckle::grin {

/// Voxels whose labels select their media; label 0 outside of the voxels.
class LabelledMedia {
 public:
  /// Requires a medium for each label.
  LabelledMedia(LabelVolume volume, std::vector<ScatteringMedium> media)
      : volume_(std::move(volume)), media_(std::move(media)) {}

  const ScatteringMedium& at(const Vec3& x) const {
    return media_[static_cast<std::size_t>(volume_.at(x))];
  }
  const LabelVolume& volume() const { return volume_; }
  double largest_extinction() const;
  /// Returns the mean coefficients over the voxels, with the mean cosine of all scattering.
  ScatteringMedium mean() const;

 private:
  LabelVolume volume_;
  std::vector<ScatteringMedium> media_;
};

/// Makes a medium of voxels from the volume and from mu_s, mu_a and g of each label. Throws
/// InputError, naming the key `name`, for invalid numbers and for a label without medium.
ScatteringMedium labelled_medium(LabelVolume volume, const std::vector<double>& media,
                                 const std::string& name);

}  // namespace flatspeckle::grin
