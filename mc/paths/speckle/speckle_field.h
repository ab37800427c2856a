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
#include "mc/paths/walk/accumulator.h"
#include "mc/paths/walk/plan.h"

namespace flatspeckle::mc {

/// Speckle fields: complex numbers u, one per channel, with E[u] = 0, E[u_a u_b] = 0 and
/// E[u_a conj(u_b)] = C_ab, the covariance of the scene (conventions, C14, C17). Each is a numbered
/// sample, a pure function of scene, seed and number. The mean (coherent) field is not in it.

/// Adds sqrt(weight) f exp(2 pi i U) to `field`, U its own for each contribution, and weight |f|^2
/// to `intensity`; both have one value per channel (C17).
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

/// Writes field `number`, and the intensity that it was drawn with: E |u|^2 per channel given all
/// but its phases, whose mean over fields is that of |u|^2 without speckle's noise. May be called
/// from several threads at once.
using FieldDraw = std::function<void(std::uint64_t number, std::span<Complex> field,
                                     std::span<double> intensity)>;

/// The channels [light][view] of a scene, for fields: no list of covariance entries.
CovarianceRequest field_request(Lights lights, std::vector<View> views);

/// A plan that walks all there is to a field: none of it is left to a closed form.
Plan plan_for_fields(Plan plan);

/// Each field from `paths` light paths of its own. Its covariance is right for any number of paths,
/// its distribution is Gaussian for many (field_plan.h).
FieldDraw fields_by_paths(const Scene& scene, const Plan& plan, std::uint64_t seed,
                          std::uint64_t paths);

/// A Hermitian, positive semidefinite matrix as F F^H with as few columns as its rank (to rounding)
/// asks for: Cholesky with complete pivoting (LAPACK zpstrf) of the matrix scaled to a unit
/// diagonal, so that no dim channel drowns in the rounding of a bright one.
class CovarianceFactor {
 public:
  /// lower: the lower triangle, row by row, as a full request's entries.
  CovarianceFactor(std::size_t channels, std::span<const Complex> lower);

  std::size_t channels() const { return scale_.size(); }
  std::size_t rank() const { return rank_; }
  double variance(std::size_t channel) const { return scale_[channel] * scale_[channel]; }
  /// out = F noise, noise of size rank().
  void apply(std::span<const Complex> noise, std::span<Complex> out) const;

 private:
  std::vector<double> scale_;    ///< standard deviations
  std::vector<Complex> factor_;  ///< channels x rank, column-major
  std::size_t rank_ = 0;
};

/// Each field as F z, z circular Gaussian.
FieldDraw fields_from_covariance(CovarianceFactor factor, std::uint64_t seed);

}  // namespace flatspeckle::mc
