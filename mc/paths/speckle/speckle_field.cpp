#include "mc/paths/speckle/speckle_field.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/numbers/blas.h"
#include "flatland/request/request.h"

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

FieldDraw fields_by_paths(const Scene& scene, const Plan& general, std::uint64_t seed,
                          std::uint64_t paths) {
  Plan plan = plan_for_fields(general);
  plan.paths_per_batch = paths;
  return [batches = path_batches(scene, plan, seed), seed, paths](
             std::uint64_t number, std::span<Complex> field, std::span<double> intensity) {
    std::fill(field.begin(), field.end(), 0);
    std::fill(intensity.begin(), intensity.end(), 0);
    FieldAccumulator accumulator(stream_of(seed, number), field, intensity);
    batches(number, accumulator);
    const double per_path = 1 / static_cast<double>(paths), amplitude = std::sqrt(per_path);
    for (Complex& u : field) u *= amplitude;
    for (double& value : intensity) value *= per_path;
  };
}

namespace {

/// Adds the ends of all paths to the sum of a camera, with one field for each light.
class CameraScorer : public PathScorer {
 public:
  CameraScorer(const PathWalks& walks, const RandomStream& phases, CameraSum& sum)
      : walks_(walks),
        phases_(phases),
        sum_(sum),
        lights_(walks.factors(walks.scene(), light_endpoints(walks.scene()), true)),
        first_(lights_->size()),
        last_(lights_->size()),
        scaled_(lights_->size()) {}

  void single(Vec x, double weight, FaceWaves) override {
    lights_->attenuate(x, last_);
    const Complex factor = draw_factor(weight);
    std::vector<Complex> only(last_.size());
    for (std::size_t i = 0; i < last_.size(); ++i) {
      only[i] = product(factor, last_[i]);
      sum_.add(x, -lights_->direction(i), only);
      only[i] = 0;
    }
  }
  void multiple(const Path& path) override {
    const Complex factor = draw_factor(path.weight);
    if (path.new_start) light(path.first, -path.start, first_);
    add(path.last, path.arrival, factor, first_);
    if (!walks_.plan().reversed) return;
    light(path.last, path.arrival, last_);
    add(path.first, -path.start, factor, last_);
  }

 private:
  Complex draw_factor(double weight) {
    return std::polar(std::sqrt(weight), 2 * std::numbers::pi * phases_.uniform());
  }
  void light(Vec x, Vec arrival, std::vector<Complex>& field) {
    lights_->attenuate(x, field);
    walks_.towards(x, arrival, lights_->directions(), field);
  }
  void add(Vec x, Vec arrival, Complex factor, const std::vector<Complex>& lights) {
    for (std::size_t i = 0; i < lights.size(); ++i) scaled_[i] = product(factor, lights[i]);
    sum_.add(x, arrival, scaled_);
  }

  const PathWalks& walks_;
  RandomStream phases_;
  CameraSum& sum_;
  std::unique_ptr<EndpointFactors> lights_;
  std::vector<Complex> first_, last_, scaled_;
};

}  // namespace

FieldDraw fields_on_camera(const Scene& scene, const Plan& general, std::uint64_t seed,
                           std::uint64_t paths, const CameraResolution& resolution) {
  Plan plan = plan_for_fields(general);
  plan.paths_per_batch = paths;
  const FarCamera camera = scene.request.camera.value();
  return [walks = path_walks(on_coarse_camera(scene), plan, seed), camera, seed, paths, resolution,
          lights = scene.request.lights.size()](std::uint64_t number, std::span<Complex> field,
                                                std::span<double> intensity) {
    std::fill(field.begin(), field.end(), 0);
    if (walks) {
      CameraSum sum(*walks, camera, resolution, lights);
      CameraScorer scorer(*walks, stream_of(seed, number), sum);
      walks->batch(number, scorer);
      sum.finish(field);
    }
    const double amplitude = std::sqrt(1 / static_cast<double>(paths));
    for (std::size_t c = 0; c < field.size(); ++c) {
      field[c] *= amplitude;
      intensity[c] = std::norm(field[c]);
    }
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
