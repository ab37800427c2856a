#include "mc/distance/distance_job.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/error.h"
#include "core/numbers/blas.h"
#include "core/result/result_group.h"
#include "core/run/interrupt.h"
#include "core/run/parallel.h"
#include "mc/distance/layered_radiance.h"
#include "mc/jobs/decay_curve.h"
#include "mc/slab/adding/space.h"
#include "mc/slab/scene_slab.h"

namespace flatspeckle::mc {

namespace {

/// Returns the moments of the phase function of a law.
std::vector<double> moments_of(const SpaceLaw& law) {
  std::vector<double> moments = law.moments();
  for (double& moment : moments) moment += law.peak();
  return moments;
}

/// Returns the moments of (1 - cos) p from those of p, by the recurrence of Legendre polynomials.
std::vector<double> turned(const std::vector<double>& p) {
  std::vector<double> result(p.size());
  for (std::size_t l = 0; l < p.size(); ++l) {
    const double n = static_cast<double>(l), below = l > 0 ? n * p[l - 1] : 0,
                 above = l + 1 < p.size() ? (n + 1) * p[l + 1] : 0;
    result[l] = p[l] - (above + below) / (2 * n + 1);
  }
  return result;
}

/// Returns the moments of p exp(-2 delay (1 - cos)) from those of p, by the exponential series in
/// steps that are short enough for it.
std::vector<double> decayed(std::vector<double> p, double delay) {
  constexpr int terms = 18;
  constexpr double longest = 1000;  // after longer delays no correlation is left
  delay = std::min(delay, longest);
  const int steps = 1 + static_cast<int>(4 * delay);
  for (int step = 0; step < steps; ++step) {
    std::vector<double> term = p;
    for (int k = 1; k <= terms; ++k) {
      term = turned(term);
      for (std::size_t l = 0; l < p.size(); ++l) {
        term[l] *= -2 * delay / (steps * k);
        p[l] += term[l];
      }
    }
  }
  return p;
}

/// Optical properties of a layer, and the moments of its phase function.
struct LayerOptics {
  double mu_t, mu_s, depth, diffusion;
  std::vector<double> moments;
};

std::vector<LayerOptics> optics_of(const Scene& scene) {
  std::vector<LayerOptics> list;
  for (const auto& layer : slab_of<SpaceGeometry>(scene).layers) {
    const double diffusion =
        scene.profile ? scene.profile->materials()[list.size()].motion.diffusion : 1;
    list.push_back(
        {layer.mu_t, layer.mu_t * layer.albedo, layer.depth, diffusion, moments_of(layer.law)});
  }
  return list;
}

/// Transport coefficients of a layer, and their derivatives by its coefficients, for l = 0 .. order
/// and for the beam (last).
struct LayerEquation {
  LayerLosses losses;
  std::array<std::vector<double>, layer_coefficients> derivatives;

  LayerEquation(const LayerOptics& layer, double delay, int order) {
    auto p = decayed(layer.moments, delay * layer.diffusion);
    p.resize(std::max(p.size(), static_cast<std::size_t>(order) + 3));
    const auto rate = turned(p);
    for (std::size_t l = 0; l < static_cast<std::size_t>(order) + 2; ++l) {
      losses.loss.push_back(layer.mu_t - layer.mu_s * p[l]);
      derivatives[0].push_back(1);
      derivatives[1].push_back(1 - p[l]);
      derivatives[2].push_back(2 * layer.mu_s * delay * rate[l]);
    }
    losses.beam = losses.loss.back();
    losses.loss.pop_back();
    losses.thickness = layer.depth;
  }

  /// Returns the derivative of the reflected light by a coefficient.
  Complex derivative(std::size_t coefficient, const LossDerivatives& by_loss) const {
    const auto& own = derivatives[coefficient];
    Complex sum = own.back() * by_loss.beam;
    for (std::size_t l = 0; l < by_loss.loss.size(); ++l) sum += own[l] * by_loss.loss[l];
    return sum;
  }
};

/// The transport problem of a slab for harmonics up to one degree.
class DistanceProblem {
 public:
  DistanceProblem(const Scene& scene, const std::vector<LayerOptics>& layers,
                  const DistanceRequest& request, int order)
      : request_(request),
        harmonics_(order),
        rotation_(harmonics_),
        contour_(request.detectors, request.source_radius) {
    const Faces faces = scene.faces.value_or(Faces{});
    const double index = faces.inside;
    entering_ = 1 - faces.entering().reflectance(1);
    top_ = harmonics_.face(faces.leaving(), std::min(1.0, request.numerical_aperture / index));
    bottom_ = harmonics_.face(faces.leaving());
    std::vector<double> delays{0};
    for (const double delay : request.dynamics.delays)
      delays.push_back(request.dynamics.motion.diffusion * delay);
    for (const double delay : delays) {
      equations_.emplace_back();
      for (const LayerOptics& layer : layers) equations_.back().emplace_back(layer, delay, order);
    }
  }

  std::size_t layers() const { return equations_[0].size(); }
  std::size_t delays() const { return equations_.size(); }

  /// Returns the values of distance_solution().
  std::vector<Complex> values() const;
  /// Returns the power on each detector at delay 0, by the radiance at the surface.
  std::vector<double> powers_by_radiance() const;

 private:
  /// Calls f(frequency, radiance) for all frequencies, in parallel.
  void each_frequency(std::size_t delay,
                      const std::function<void(std::size_t, const LayeredRadiance&)>& f) const;

  const DistanceRequest& request_;
  RadianceHarmonics harmonics_;
  HarmonicRotation rotation_;
  HankelContour contour_;
  double entering_;  ///< fraction of the beam that enters the medium
  FaceConditions top_, bottom_;
  std::vector<std::vector<LayerEquation>> equations_;  ///< [delay][layer]
};

void DistanceProblem::each_frequency(
    std::size_t delay, const std::function<void(std::size_t, const LayeredRadiance&)>& f) const {
  std::vector<LayerLosses> losses;
  std::vector<std::vector<AxialMode>> axial;
  for (const LayerEquation& equation : equations_[delay]) {
    losses.push_back(equation.losses);
    axial.push_back(axial_modes(equation.losses, harmonics_.order()));
  }
  parallel_for(contour_.frequencies().size(), [&](std::size_t n) {
    std::vector<LayerModes> modes;
    for (const auto& layer : axial)
      modes.emplace_back(rotation_, harmonics_, layer, contour_.frequencies()[n]);
    f(n, LayeredRadiance(harmonics_, losses, std::move(modes), top_, bottom_));
  });
}

std::vector<Complex> DistanceProblem::values() const {
  const std::size_t detectors = request_.detectors.size(), block = delays() * detectors,
                    parts = request_.gradient ? 1 + layer_coefficients * layers() : 1;
  std::vector<Complex> values(parts * block);
  for (std::size_t t = 0; t < delays(); ++t) {
    stop_if_interrupted();
    std::vector<std::vector<Complex>> found(parts,
                                            std::vector<Complex>(contour_.frequencies().size()));
    each_frequency(t, [&](std::size_t n, const LayeredRadiance& radiance) {
      const Reflected reflected = radiance.reflected(request_.gradient);
      found[0][n] = reflected.power;
      for (std::size_t part = 1; part < parts; ++part) {
        const std::size_t layer = (part - 1) / layer_coefficients;
        found[part][n] = equations_[t][layer].derivative((part - 1) % layer_coefficients,
                                                         reflected.derivatives[layer]);
      }
    });
    for (std::size_t part = 0; part < parts; ++part)
      for (std::size_t d = 0; d < detectors; ++d)
        values[part * block + t * detectors + d] = entering_ * contour_.power(d, found[part]);
  }
  return values;
}

std::vector<double> DistanceProblem::powers_by_radiance() const {
  std::vector<Complex> found(contour_.frequencies().size());
  each_frequency(0, [&](std::size_t n, const LayeredRadiance& radiance) {
    found[n] = radiance.reflected_by_radiance();
  });
  std::vector<double> powers;
  for (std::size_t d = 0; d < request_.detectors.size(); ++d)
    powers.push_back(entering_ * contour_.power(d, found));
  return powers;
}

/// Returns the magnitude to which the tolerance of each value is relative: the value itself, but at
/// least a hundredth of that without delay. Derivatives are skipped.
std::vector<double> scales_of(std::span<const Complex> values, const DistanceRequest& request) {
  constexpr double least = 0.01;
  const std::size_t detectors = request.detectors.size(),
                    fields = (request.dynamics.delays.size() + 1) * detectors;
  std::vector<double> scales(values.size());
  for (std::size_t n = 0; n < fields; ++n)
    scales[n] = std::max(std::abs(values[n]), least * std::abs(values[n % detectors]));
  return scales;
}

constexpr int first_order = 5, last_order = 15;

}  // namespace

Refined distance_solution(const Scene& slab, const DistanceRequest& request, double tolerance) {
  blas_single_thread();
  const auto layers = optics_of(slab);
  Refined found;
  found.value = DistanceProblem(slab, layers, request, first_order).values();
  for (int order = first_order + 2; order <= last_order; order += 2) {
    const auto finer = DistanceProblem(slab, layers, request, order).values();
    found.error.resize(finer.size());
    for (std::size_t n = 0; n < finer.size(); ++n)
      found.error[n] = std::abs(finer[n] - found.value[n]);
    found.value = finer;
    found.ordinates = order;
    if (worst_error(found, scales_of(found.value, request)) < tolerance) break;
  }
  return found;
}

BatchJob distance_job(const Scene& slab, const DistanceRequest& request, double tolerance) {
  const auto* profile = slab.profile.get();
  const std::size_t layers = profile != nullptr ? profile->materials().size() : 1,
                    parts = request.gradient ? 1 + layer_coefficients * layers : 1,
                    delays = request.dynamics.delays.size() + 1;
  return two_batches(
      parts * delays * request.detectors.size(),
      [=] { return distance_solution(slab, request, tolerance); },
      [=](std::span<const Complex> values) { return scales_of(values, request); });
}

std::vector<Invariant> reciprocity(const Scene& slab, const DistanceRequest& request,
                                   double tolerance) {
  DistanceRequest powers = request;
  powers.dynamics.delays.clear();
  powers.gradient = false;
  const DistanceProblem problem(slab, optics_of(slab), powers, first_order);
  const auto adjoint = problem.values();
  const auto direct = problem.powers_by_radiance();
  std::vector<Invariant> checks;
  for (std::size_t d = 0; d < direct.size(); ++d)
    checks.push_back({std::abs(direct[d] / adjoint[d].real() - 1), tolerance});
  return checks;
}

}  // namespace flatspeckle::mc
