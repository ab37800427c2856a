#pragma once

#include <cstdint>
#include <functional>
#include <numbers>
#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "core/numbers/random.h"
#include "flatland/scene/scene.h"
#include "mc/paths/estimators/covariance_estimator.h"
#include "mc/paths/speckle/camera_sides.h"
#include "mc/paths/speckle/field_changes.h"
#include "mc/paths/walk/accumulator.h"
#include "mc/paths/walk/plan.h"

namespace flatspeckle::mc {

/// A speckle field is a set of complex numbers u, one per channel, with E[u] = 0, E[u_a u_b] = 0
/// and E[u_a conj(u_b)] = C_ab, the covariance of the scene (conventions, C14, C17). Fields are
/// numbered; each is a pure function of scene, seed and number. The mean (coherent) field is not
/// included.

/// Adds sqrt(weight) f exp(2 pi i U) to `field`, with an independent U for each contribution, and
/// weight |f|^2 to `intensity`; both have one value per channel (C17).
class FieldAccumulator : public Accumulator {
 public:
  FieldAccumulator(const RandomStream& phases, std::span<Complex> field,
                   std::span<double> intensity)
      : phases_(phases), field_(field), intensity_(intensity) {}

  void add(double weight, std::span<const Complex> f) override {
    const Complex factor = std::polar(std::sqrt(weight), 2 * std::numbers::pi * phases_.uniform());
    for (std::size_t c = 0; c < f.size(); ++c) {
      field_[c] += product(factor, f[c]);
      intensity_[c] += weight * std::norm(f[c]);
    }
  }

 private:
  RandomStream phases_;
  std::span<Complex> field_;
  std::span<double> intensity_;
};

/// Computes field `number`, and for each channel the intensity with which it was drawn: E|u|^2
/// conditional on everything except the random phases. The mean of this intensity over fields is
/// the mean of |u|^2, but without the noise of speckle. The function may be called from several
/// threads at once.
using FieldDraw = std::function<void(std::uint64_t number, std::span<Complex> field,
                                     std::span<double> intensity)>;

/// Makes a request for fields in the channels [light][view], without a list of covariance entries.
CovarianceRequest field_request(Lights lights, std::vector<View> views);

/// Returns the plan with such changes that walks sample all contributions to a field, including
/// those that have a closed form.
Plan plan_for_fields(Plan plan);

/// Draws each field from `paths` separate light paths. The covariance of the fields is exact for
/// any number of paths; their distribution becomes Gaussian for many paths (field_plan.h). The
/// fields after the changes have the order [change][light][view].
FieldDraw fields_by_paths(const Scene& scene, const Plan& plan, std::uint64_t seed,
                          std::uint64_t paths, const FieldChanges& changes = {});

/// Draws fields by paths on the camera of a box in space, by a CameraSum. If reversed paths are
/// included, the intensity of FieldDraw is |u|^2, with the noise of speckle.
FieldDraw fields_on_camera(const Scene& scene, const Plan& plan, std::uint64_t seed,
                           std::uint64_t paths, const CameraResolution& resolution,
                           const FieldChanges& changes = {});

/// Factorisation F F^H of a Hermitian, positive semidefinite matrix, in which F has as many columns
/// as the rank of the matrix (to rounding). It is computed by Cholesky factorisation with complete
/// pivoting (LAPACK zpstrf) of the matrix scaled to a unit diagonal, so that no dim channel is lost
/// in the rounding errors of a bright channel.
class CovarianceFactor {
 public:
  /// lower: the lower triangle of the matrix, row by row, like the entries of a full request.
  CovarianceFactor(std::size_t channels, std::span<const Complex> lower);

  std::size_t channels() const { return scale_.size(); }
  std::size_t rank() const { return rank_; }
  double variance(std::size_t channel) const { return scale_[channel] * scale_[channel]; }
  /// Computes out = F noise. noise: rank() values.
  void apply(std::span<const Complex> noise, std::span<Complex> out) const;

 private:
  std::vector<double> scale_;    ///< standard deviation of each channel
  std::vector<Complex> factor_;  ///< channels x rank, column-major
  std::size_t rank_ = 0;
};

/// Draws each field as F z, where F is the covariance factor and z are independent circular
/// Gaussian numbers.
FieldDraw fields_from_covariance(CovarianceFactor factor, std::uint64_t seed);

}  // namespace flatspeckle::mc
