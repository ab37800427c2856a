#include "mc/paths/bent/graded_medium.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "grin/media/fields/gaussian_blobs.h"
#include "grin/media/fields/parabolic.h"
#include "grin/media/fields/spline_field.h"
#include "grin/media/fields/ultrasound.h"
#include "mc/paths/bent/linear_medium.h"
#include "mc/paths/bent/mean_field_medium.h"
#include "mc/paths/bent/stepped_medium.h"

namespace flatspeckle::mc {

namespace {

template <class Field>
std::shared_ptr<const GradedMedium> in_steps(const Scene& scene, Field field) {
  const double scale = facts(field).scale;
  return std::make_shared<const SteppedMedium<Field>>(scene, std::move(field), scale);
}

grin::GaussianBlobs blobs_of(const IndexField& field) {
  std::vector<grin::GaussianBlob> blobs;
  for (const IndexBlob& blob : field.blobs)
    blobs.push_back({{blob.centre.x, 0, blob.centre.z}, blob.height, blob.width});
  return grin::GaussianBlobs(std::move(blobs), field.origin - 1);
}

grin::StandingWave sound_of(const Scene& scene) {
  constexpr double longest_table = 1e3;  // in k rho; beyond it the wave is slow, not wrong
  const IndexField& field = *scene.index;
  const double reach = 4 * (scene.domain.width + scene.domain.depth);
  return {field.origin - 1, field.sound_amplitude, 0, field.sound_wavenumber,
          std::min(reach, longest_table / field.sound_wavenumber)};
}

}  // namespace

std::shared_ptr<const Wavefront> GradedMedium::from_point(Vec2 source) const {
  const std::scoped_lock lock(making_);
  auto& wave = from_points_[source];
  if (!wave) wave = wave_from_point(source);
  return wave;
}

std::shared_ptr<const Wavefront> GradedMedium::from_afar(double angle) const {
  const std::scoped_lock lock(making_);
  auto& wave = from_afar_[angle];
  if (!wave) wave = wave_from_afar(angle);
  return wave;
}

std::shared_ptr<const GradedMedium> graded_medium(const Scene& scene) {
  const IndexField& field = *scene.index;
  switch (field.kind) {
    case IndexField::Kind::linear:
      return std::make_shared<const LinearMedium>(scene.domain, field);
    case IndexField::Kind::parabolic:
      return in_steps(scene,
                      grin::ParabolicGuide({field.origin - 1, field.alpha}, grin::Vec3(0, 0, 0)));
    case IndexField::Kind::blobs:
      return in_steps(scene, blobs_of(field));
    case IndexField::Kind::ultrasound:
      return in_steps(scene, sound_of(scene));
    case IndexField::Kind::grid:
      return in_steps(scene, grin::read_spline_field(field.grid));
    case IndexField::Kind::mean_field:
      return std::make_shared<const MeanFieldMedium>(scene);
    case IndexField::Kind::homogeneous:
      break;
  }
  throw InputError("index_field", field.describe(), "is not of light paths");
}

}  // namespace flatspeckle::mc
