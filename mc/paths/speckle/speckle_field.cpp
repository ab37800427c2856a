#include "mc/paths/speckle/speckle_field.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/numbers/blas.h"
#include "core/numbers/phasor.h"
#include "flatland/request/request.h"
#include "mc/paths/estimators/path_endpoints.h"
#include "mc/paths/speckle/camera_ends.h"
#include "mc/paths/speckle/camera_intensity.h"
#include "mc/paths/speckle/camera_resolution.h"
#include "mc/paths/speckle/camera_sum.h"

namespace flatspeckle::mc {

namespace {

/// Samples z with E|z|^2 = 1 and E[z^2] = 0 (Box and Muller).
Complex circular_gaussian(RandomStream& random) {
  const double radius = std::sqrt(-std::log(random.uniform()));
  return std::polar(radius, 2 * std::numbers::pi * random.uniform());
}

RandomStream stream_of(std::uint64_t seed, std::uint64_t number) {
  return {seed, static_cast<std::uint64_t>(Stream::fields), number};
}

}  // namespace

CovarianceRequest field_request(Lights lights, std::vector<View> views) {
  CovarianceRequest request = intensity_request(std::move(lights), std::move(views));
  request.kind = CovarianceRequest::Kind::full;
  request.entries.clear();
  return request;
}

Plan plan_for_fields(Plan plan) {
  plan.phases = true;
  plan.sampled_single = plan.single_roulette = true;
  return plan;
}

namespace {

/// Adds the fields of all paths after each change to a field and its intensity,
/// [change][light][view] (FieldAccumulator). Lights and views must be plane waves and far views.
class ChangedFieldScorer : public TallyScorer<ChangeTally> {
 public:
  ChangedFieldScorer(const PathWalks& walks, ChangeDraw& changes, const RandomStream& random,
                     std::span<Complex> field, std::span<double> intensity)
      : TallyScorer(changes.no_tally()),
        walks_(walks),
        changes_(changes),
        random_(random),
        field_(field),
        intensity_(intensity),
        endpoints_(walks, [](std::size_t count) { return std::vector<Complex>(count); }),
        turned_light_(endpoints_.lights().size()),
        turned_view_(endpoints_.views().size()),
        sum_(turned_light_.size() * turned_view_.size()) {}

  void single(Vec x, double weight, FaceWaves waves) override {
    endpoints_.choose(waves);
    const Complex factor = draw_factor(weight);
    EndpointFactors &lights = endpoints_.lights(), &views = endpoints_.views();
    lights.attenuate(x, endpoints_.light_last);
    views.attenuate(x, endpoints_.view_last);
    std::size_t first = 0;
    for (const ChangedPath& changed : changes_.draw_single(x, random_)) {
      add_product(endpoints_.light_last, changed.first_move, endpoints_.view_last,
                  changed.first_move);
      for (std::size_t i = 0; i < lights.size(); ++i)
        walks_.towards(x, -lights.direction(i), views.directions(),
                       std::span(sum_).subspan(i * views.size(), views.size()));
      finish(first++, factor);
    }
  }
  void multiple(const Path& path) override {
    const Complex factor = draw_factor(path.weight);
    endpoints_.find(path, [this](EndpointFactors& endpoints, Vec x, Vec arrival, auto& out) {
      endpoints.attenuate(x, out);
      walks_.towards(x, arrival, endpoints.directions(), out);
    });
    std::size_t first = 0;
    for (const ChangedPath& changed : changes_.draw(path, tally(), random_)) {
      add_product(endpoints_.light_first, changed.first_move, endpoints_.view_last,
                  changed.last_move);
      if (endpoints_.reversed())
        add_product(endpoints_.light_last, changed.last_move, endpoints_.view_first,
                    changed.first_move);
      finish(first++, product(factor, changed.factor));
    }
  }

 private:
  Complex draw_factor(double weight) {
    return std::polar(std::sqrt(weight), 2 * std::numbers::pi * random_.uniform());
  }
  /// Multiplies the values of far endpoints by the phases of a move.
  void turn(EndpointFactors& endpoints, const std::vector<Complex>& value, Vec move,
            std::vector<Complex>& out) {
    phase_.resize(out.size()), zero_.resize(out.size());
    for (std::size_t j = 0; j < out.size(); ++j)
      phase_[j] = -walks_.scene().k * dot(endpoints.direction(j), move);
    damped_phasors(phase_, zero_, out);
    for (std::size_t j = 0; j < out.size(); ++j) out[j] = product(value[j], out[j]);
  }
  void add_product(const std::vector<Complex>& light, Vec light_move,
                   const std::vector<Complex>& view, Vec view_move) {
    turn(endpoints_.lights(), light, light_move, turned_light_);
    turn(endpoints_.views(), view, view_move, turned_view_);
    for (std::size_t i = 0; i < turned_light_.size(); ++i)
      for (std::size_t v = 0; v < turned_view_.size(); ++v)
        sum_[i * turned_view_.size() + v] += product(turned_light_[i], turned_view_[v]);
  }
  /// Adds the field of a path after a change.
  void finish(std::size_t change, Complex factor) {
    for (std::size_t c = 0; c < sum_.size(); ++c) {
      const Complex u = product(factor, sum_[c]);
      field_[change * sum_.size() + c] += u;
      intensity_[change * sum_.size() + c] += std::norm(u);
      sum_[c] = 0;
    }
  }

  const PathWalks& walks_;
  ChangeDraw& changes_;
  RandomStream random_;
  std::span<Complex> field_;
  std::span<double> intensity_;
  PathEndpoints<std::vector<Complex>> endpoints_;
  std::vector<double> phase_, zero_;
  std::vector<Complex> turned_light_, turned_view_;
  std::vector<Complex> sum_;  ///< field of the path, [light][view]
};

/// Divides by the number of paths.
void average(std::uint64_t paths, std::span<Complex> field, std::span<double> intensity) {
  const double per_path = 1 / static_cast<double>(paths), amplitude = std::sqrt(per_path);
  for (Complex& u : field) u *= amplitude;
  for (double& value : intensity) value *= per_path;
}

FieldDraw changed_fields_by_paths(const Scene& scene, const Plan& plan, std::uint64_t seed,
                                  std::uint64_t paths, const FieldChanges& changes) {
  return [walks = path_walks(scene, plan, seed), seed, paths, changes](
             std::uint64_t number, std::span<Complex> field, std::span<double> intensity) {
    std::fill(field.begin(), field.end(), 0);
    std::fill(intensity.begin(), intensity.end(), 0);
    if (!walks) return;
    ChangeDraw draw(walks->scene(), changes);
    ChangedFieldScorer scorer(*walks, draw, stream_of(seed, number), field, intensity);
    walks->batch(number, scorer);
    average(paths, field, intensity);
  };
}

}  // namespace

FieldDraw fields_by_paths(const Scene& scene, const Plan& general, std::uint64_t seed,
                          std::uint64_t paths, const FieldChanges& changes) {
  Plan plan = plan_for_fields(general);
  plan.paths_per_batch = paths;
  if (!changes.none()) return changed_fields_by_paths(scene, plan, seed, paths, changes);
  return [batches = path_batches(scene, plan, seed), seed, paths](
             std::uint64_t number, std::span<Complex> field, std::span<double> intensity) {
    std::fill(field.begin(), field.end(), 0);
    std::fill(intensity.begin(), intensity.end(), 0);
    FieldAccumulator accumulator(stream_of(seed, number), field, intensity);
    batches(number, accumulator);
    average(paths, field, intensity);
  };
}

FieldDraw fields_on_camera(const Scene& scene, const Plan& general, std::uint64_t seed,
                           std::uint64_t paths, const CameraResolution& resolution,
                           const FieldChanges& changes) {
  Plan plan = plan_for_fields(general);
  plan.paths_per_batch = paths;
  const FarCamera camera = scene.request.camera.value();
  return [walks = path_walks(on_coarse_camera(scene), plan, seed), camera, seed, paths, resolution,
          changes, count = changes.count() * scene.request.lights.size()](
             std::uint64_t number, std::span<Complex> field, std::span<double> intensity) {
    std::fill(field.begin(), field.end(), 0);
    std::fill(intensity.begin(), intensity.end(), 0);
    if (!walks) return;
    CameraSum sum(*walks, camera, resolution, count);
    CameraIntensity mean(*walks, camera, resolution, count);
    each_end(*walks, number, changes, stream_of(seed, number),
             [&](const PathEnd& end, std::span<const Complex> factors, std::size_t first) {
               sum.add(end, factors, first);
               mean.add(end, factors, first);
             });
    sum.finish(field);
    mean.finish(intensity);
    average(paths, field, intensity);
    // Interference with reversed paths is only in the field
    if (walks->plan().reversed)
      std::ranges::transform(field, intensity.begin(), [](Complex u) { return std::norm(u); });
  };
}

CovarianceFactor::CovarianceFactor(std::size_t channels, std::span<const Complex> lower)
    : scale_(channels) {
  if (channels == 0) return;
  blas_single_thread();
  const auto entry = [&](std::size_t a, std::size_t b) { return lower[triangle_entry(a, b)]; };
  for (std::size_t a = 0; a < channels; ++a)
    scale_[a] = std::sqrt(std::max(entry(a, a).real(), 0.0));
  std::vector<Complex> matrix(channels * channels);
  for (std::size_t a = 0; a < channels; ++a)
    for (std::size_t b = 0; b <= a; ++b)
      if (const double unit = scale_[a] * scale_[b]; unit > 0)
        matrix[a + b * channels] = entry(a, b) / unit;

  const auto n = static_cast<lapack_int>(channels);
  // row[i]: number, from 1, of the row of the matrix that pivoting has moved to row i
  std::vector<lapack_int> row(channels);
  lapack_int rank = 0;
  // Negative: LAPACK uses its default tolerance, n x epsilon x largest diagonal element
  constexpr double rounding = -1;
  LAPACKE_zpstrf(LAPACK_COL_MAJOR, 'L', n, matrix.data(), n, row.data(), &rank, rounding);
  rank_ = static_cast<std::size_t>(rank);
  factor_.resize(channels * rank_);
  for (std::size_t k = 0; k < rank_; ++k) {
    for (std::size_t i = k; i < channels; ++i) {
      const auto to = static_cast<std::size_t>(row[i] - 1);
      factor_[to + k * channels] = scale_[to] * matrix[i + k * channels];
    }
  }
}

/// Does not use zgemv, which in OpenBLAS 0.3.21 reads beyond the end of a matrix (OpenBLAS issue
/// 4013).
void CovarianceFactor::apply(std::span<const Complex> noise, std::span<Complex> out) const {
  std::fill(out.begin(), out.end(), 0);
  for (std::size_t k = 0; k < rank_; ++k) {
    const Complex* const column = factor_.data() + k * channels();
    for (std::size_t c = 0; c < channels(); ++c) out[c] += product(column[c], noise[k]);
  }
}

FieldDraw fields_from_covariance(CovarianceFactor factor, std::uint64_t seed) {
  const auto shared = std::make_shared<const CovarianceFactor>(std::move(factor));
  return
      [shared, seed](std::uint64_t number, std::span<Complex> field, std::span<double> intensity) {
        RandomStream random = stream_of(seed, number);
        std::vector<Complex> noise(shared->rank());
        for (Complex& z : noise) z = circular_gaussian(random);
        shared->apply(noise, field);
        for (std::size_t c = 0; c < intensity.size(); ++c) intensity[c] = shared->variance(c);
      };
}

}  // namespace flatspeckle::mc
