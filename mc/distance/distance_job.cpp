#include "mc/distance/distance_job.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>

#include "core/error.h"
#include "core/numbers/blas.h"
#include "core/result/result_group.h"
#include "core/run/interrupt.h"
#include "core/run/parallel.h"
#include "mc/distance/delay_interpolation.h"
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

/// Reflected light at some frequencies of a contour, one per row: its power, and its derivatives by
/// [layer][coefficient].
using Spectrum = Eigen::MatrixXcd;

/// Numbers of delays or of frequencies of a contour.
using Numbers = std::vector<std::size_t>;

Numbers numbers_below(std::size_t count) {
  Numbers numbers(count);
  std::iota(numbers.begin(), numbers.end(), std::size_t{0});
  return numbers;
}

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

  int order() const { return harmonics_.order(); }
  Numbers all_delays() const { return numbers_below(delays()); }
  Numbers all_frequencies() const { return numbers_below(contour_.frequencies().size()); }

  /// Returns the spectrum after each of these delays.
  std::vector<Spectrum> spectra(const Numbers& delays, const Numbers& frequencies) const;
  /// Returns the contribution of a frequency to the power on a detector.
  Complex contribution(std::size_t detector, std::size_t frequency, Complex reflected) const {
    return entering_ * contour_.weight(detector, frequency) * reflected;
  }
  /// Returns the sums of the contributions, [part][delay][detector].
  std::vector<Complex> values(const std::vector<Spectrum>& spectra,
                              const Numbers& frequencies) const;
  /// Returns the power on each detector at delay 0, by the radiance at the surface.
  std::vector<double> powers_by_radiance() const;

 private:
  std::size_t parts() const {
    return request_.gradient ? 1 + layer_coefficients * layers() : std::size_t{1};
  }
  /// Calls f(position in the list, radiance) for each of the frequencies, in parallel.
  void each_frequency(std::size_t delay, const Numbers& frequencies,
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
    std::size_t delay, const Numbers& frequencies,
    const std::function<void(std::size_t, const LayeredRadiance&)>& f) const {
  std::vector<LayerLosses> losses;
  std::vector<std::vector<AxialMode>> axial;
  for (const LayerEquation& equation : equations_[delay]) {
    losses.push_back(equation.losses);
    axial.push_back(axial_modes(equation.losses, harmonics_.order()));
  }
  parallel_for(frequencies.size(), [&](std::size_t n) {
    const Complex q = contour_.frequencies()[frequencies[n]];
    std::vector<LayerModes> modes;
    for (const auto& layer : axial) modes.emplace_back(rotation_, harmonics_, layer, q);
    f(n, LayeredRadiance(harmonics_, losses, std::move(modes), top_, bottom_));
  });
}

std::vector<Spectrum> DistanceProblem::spectra(const Numbers& delays,
                                               const Numbers& frequencies) const {
  std::vector<Spectrum> all;
  for (const std::size_t t : delays) {
    stop_if_interrupted();
    Spectrum& found = all.emplace_back(frequencies.size(), parts());
    each_frequency(t, frequencies, [&](std::size_t n, const LayeredRadiance& radiance) {
      const auto row = static_cast<Eigen::Index>(n);
      const Reflected reflected = radiance.reflected(request_.gradient);
      found(row, 0) = reflected.power;
      for (std::size_t part = 1; part < parts(); ++part) {
        const std::size_t layer = (part - 1) / layer_coefficients;
        found(row, static_cast<Eigen::Index>(part)) = equations_[t][layer].derivative(
            (part - 1) % layer_coefficients, reflected.derivatives[layer]);
      }
    });
  }
  return all;
}

std::vector<Complex> DistanceProblem::values(const std::vector<Spectrum>& spectra,
                                             const Numbers& frequencies) const {
  std::vector<Complex> values;
  for (std::size_t part = 0; part < parts(); ++part)
    for (const Spectrum& spectrum : spectra)
      for (std::size_t d = 0; d < request_.detectors.size(); ++d) {
        double sum = 0;
        for (std::size_t n = 0; n < frequencies.size(); ++n)
          sum +=
              contribution(d, frequencies[n],
                           spectrum(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(part)))
                  .real();
        values.emplace_back(sum);
      }
  return values;
}

std::vector<double> DistanceProblem::powers_by_radiance() const {
  std::vector<double> powers(request_.detectors.size());
  std::vector<Complex> found(contour_.frequencies().size());
  each_frequency(0, all_frequencies(), [&](std::size_t n, const LayeredRadiance& radiance) {
    found[n] = radiance.reflected_by_radiance();
  });
  for (std::size_t d = 0; d < powers.size(); ++d)
    for (std::size_t n = 0; n < found.size(); ++n) powers[d] += contribution(d, n, found[n]).real();
  return powers;
}

/// Returns the magnitude to which errors of each value are relative: the value itself, but at least
/// a hundredth of the largest one over the delays.
std::vector<double> sizes_of(std::span<const Complex> values, const DistanceRequest& request) {
  constexpr double least = 0.01;
  const std::size_t detectors = request.detectors.size(),
                    block = (request.dynamics.delays.size() + 1) * detectors;
  std::vector<double> largest(values.size() / block * detectors), sizes;
  const auto at = [&](std::size_t n) { return n / block * detectors + n % detectors; };
  for (std::size_t n = 0; n < values.size(); ++n)
    largest[at(n)] = std::max(largest[at(n)], std::abs(values[n]));
  for (std::size_t n = 0; n < values.size(); ++n)
    sizes.push_back(std::max(std::abs(values[n]), least * largest[at(n)]));
  return sizes;
}

/// Returns the scales for the tolerance, which does not apply to derivatives.
std::vector<double> scales_of(std::span<const Complex> values, const DistanceRequest& request) {
  auto scales = sizes_of(values, request);
  const std::size_t fields = (request.dynamics.delays.size() + 1) * request.detectors.size();
  std::fill(scales.begin() + static_cast<std::ptrdiff_t>(fields), scales.end(), 0);
  return scales;
}

/// Returns the largest absolute value relative to its scale; infinity if a value is not finite.
double worst(std::span<const Complex> values, const std::vector<double>& scales) {
  double worst = 0;
  for (std::size_t n = 0; n < scales.size(); ++n) {
    if (!std::isfinite(std::abs(values[n]))) return std::numeric_limits<double>::infinity();
    if (scales[n] > 0) worst = std::max(worst, std::abs(values[n]) / scales[n]);
  }
  return worst;
}

/// Solves with harmonics of increasing degree. The first two degrees are solved after all delays
/// and at all frequencies. Corrections by higher degrees are computed only after some delays,
/// between which they are interpolated, and at some frequencies: those that would have been
/// sufficient for the correction from the first degree to the second, within a small fraction of
/// the tolerance.
class DistanceSolution {
 public:
  static constexpr int first_order = 5, last_order = 15;

  DistanceSolution(const Scene& slab, const DistanceRequest& request, double tolerance)
      : layers_(optics_of(slab)),
        request_(request),
        neglected_(0.05 * tolerance),
        base_(slab, layers_, request, first_order + 2),
        base_spectra_(base_.spectra(base_.all_delays(), base_.all_frequencies())),
        base_values_(base_.values(base_spectra_, base_.all_frequencies())),
        interpolation_errors_(base_values_.size()) {
    const DistanceProblem first(slab, layers_, request, first_order);
    auto changes = base_spectra_;
    const auto lowest = first.spectra(base_.all_delays(), base_.all_frequencies());
    for (std::size_t t = 0; t < changes.size(); ++t) changes[t] -= lowest[t];
    found_ = {base_values_, base_.values(changes, base_.all_frequencies()), first_order + 2};
    for (Complex& error : found_.error) error = std::abs(error);
    if (error() < tolerance) return;
    choose_frequencies(changes);
    choose_delays(changes);
    for (int order = first_order + 4; order <= last_order && !(error() < tolerance); order += 2)
      refine(DistanceProblem(slab, layers_, request, order));
  }

  const Refined& found() const { return found_; }

 private:
  double error() const { return worst(found_.error, scales_of(found_.value, request_)); }

  /// Chooses the frequencies at which `changes`, the correction from the first degree to the
  /// second, matters.
  void choose_frequencies(const std::vector<Spectrum>& changes) {
    const auto sizes = sizes_of(base_values_, request_);
    const std::size_t detectors = request_.detectors.size();
    const double most = neglected_ / static_cast<double>(base_.all_frequencies().size());
    const auto matters = [&](std::size_t n) {
      for (std::size_t i = 0; i < sizes.size(); ++i) {
        const std::size_t t = i / detectors % changes.size(),
                          part = i / (detectors * changes.size());
        const Complex change =
            changes[t](static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(part));
        if (std::abs(base_.contribution(i % detectors, n, change)) > most * sizes[i]) return true;
      }
      return false;
    };
    for (const std::size_t n : base_.all_frequencies())
      if (matters(n)) frequencies_.push_back(n);
  }

  /// Chooses a few delays if the same correction can be interpolated between them, else all.
  void choose_delays(std::vector<Spectrum> changes) {
    constexpr int points = 6;
    delays_ = base_.all_delays();
    const std::size_t detectors = request_.detectors.size();
    const std::span<const Complex> values(base_values_);
    const DelayInterpolation between(values.first(delays_.size() * detectors), detectors, points);
    for (Spectrum& change : changes) change = Spectrum(change(frequencies_, Eigen::all));
    std::vector<Spectrum> some;
    for (const std::size_t t : between.chosen()) some.push_back(changes[t]);
    auto errors = between(base_.values(some, frequencies_));
    const auto exact = base_.values(changes, frequencies_);
    for (std::size_t n = 0; n < errors.size(); ++n) errors[n] -= exact[n];
    if (!(worst(errors, sizes_of(base_values_, request_)) < neglected_)) return;
    delays_ = between.chosen();
    between_delays_ = between;
    for (std::size_t n = 0; n < errors.size(); ++n) interpolation_errors_[n] = std::abs(errors[n]);
  }

  /// Replaces the values by those of a higher degree.
  void refine(const DistanceProblem& finer) {
    auto changes = finer.spectra(delays_, frequencies_);
    for (std::size_t j = 0; j < delays_.size(); ++j)
      changes[j] -= base_spectra_[delays_[j]](frequencies_, Eigen::all);
    auto values = finer.values(changes, frequencies_);
    if (between_delays_) values = (*between_delays_)(values);
    for (std::size_t n = 0; n < values.size(); ++n) {
      values[n] += base_values_[n];
      found_.error[n] = std::abs(values[n] - found_.value[n]) + interpolation_errors_[n];
    }
    found_.value = std::move(values);
    found_.ordinates = finer.order();
  }

  std::vector<LayerOptics> layers_;
  const DistanceRequest& request_;
  double neglected_;  ///< relative error by corrections that are left out
  DistanceProblem base_;
  std::vector<Spectrum> base_spectra_;
  std::vector<Complex> base_values_;
  Numbers delays_, frequencies_;
  std::optional<DelayInterpolation> between_delays_;
  std::vector<double> interpolation_errors_;  ///< of the correction from the first degree
  Refined found_;
};

}  // namespace

Refined distance_solution(const Scene& slab, const DistanceRequest& request, double tolerance) {
  blas_single_thread();
  return DistanceSolution(slab, request, tolerance).found();
}

std::vector<Complex> distance_values(const Scene& slab, const DistanceRequest& request,
                                     int degree) {
  blas_single_thread();
  const DistanceProblem problem(slab, optics_of(slab), request, degree);
  const Numbers all = problem.all_frequencies();
  return problem.values(problem.spectra(problem.all_delays(), all), all);
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
  const DistanceProblem problem(slab, optics_of(slab), powers, DistanceSolution::first_order);
  const auto adjoint =
      problem.values(problem.spectra({0}, problem.all_frequencies()), problem.all_frequencies());
  const auto direct = problem.powers_by_radiance();
  std::vector<Invariant> checks;
  for (std::size_t d = 0; d < direct.size(); ++d)
    checks.push_back({std::abs(direct[d] / adjoint[d].real() - 1), tolerance});
  return checks;
}

}  // namespace flatspeckle::mc
