#include "mc/paths/speckle/camera_resolution.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/numbers/random.h"
#include "mc/paths/speckle/camera_ends.h"
#include "mc/paths/speckle/camera_sum.h"
#include "mc/paths/speckle/speckle_field.h"

namespace flatspeckle::mc {

namespace {

/// Batch of the ends at which errors are measured. Its number is larger than that of any field and
/// of the pilot run.
constexpr std::uint64_t trial_batch = (std::uint64_t{1} << 62) + (std::uint64_t{1} << 61);

/// Errors of the parts of a CameraSum: rms over the pixels of a coarse camera and over ends of
/// paths, relative to the rms field.
class CameraTrial {
 public:
  CameraTrial(const PathWalks& walks, FarCamera camera, std::uint64_t seed)
      : box_(walks, coarse(camera)),
        grid_(pixel_coordinates(box_.camera())),
        pixels_(box_.square(grid_)) {
    const RandomStream phases(seed, static_cast<std::uint64_t>(Stream::fields), trial_batch);
    each_end(walks, trial_batch, {}, phases,
             [&](const PathEnd& end, std::span<const Complex> factors, std::size_t) {
               if (ends_.size() == most_ends) return;
               double weight = 0;
               for (const Complex c : factors) weight += std::norm(c);
               ends_.push_back(end);
               weights_.push_back(weight);
               add_exact(end, weight);
             });
  }

  /// Error of the interpolation between nodes of the camera.
  double of_nodes(std::size_t count) const {
    const auto node = chebyshev_nodes(count);
    const Directions directions = box_.square(node);
    std::vector<std::vector<double>> interpolated;
    for (const double t : grid_) interpolated.push_back(lagrange(node, t));
    std::vector<Complex> value(directions.size()), rows(side * count);
    double sum = 0;
    for (std::size_t e = 0; e < ends_.size(); ++e) {
      find_values(ends_[e], directions, value);
      for (std::size_t row = 0; row < side; ++row)
        for (std::size_t a = 0; a < count; ++a) {
          rows[row * count + a] = 0;
          for (std::size_t b = 0; b < count; ++b)
            rows[row * count + a] += interpolated[row][b] * value[b * count + a];
        }
      double squares = 0;
      for (std::size_t pixel = 0; pixel < size; ++pixel) {
        Complex off = -exact_[e * size + pixel];
        for (std::size_t a = 0; a < count; ++a)
          off += interpolated[pixel % side][a] * rows[pixel / side * count + a];
        squares += std::norm(off);
      }
      sum += weights_[e] * squares;
    }
    return std::sqrt(sum / all_);
  }

  /// Error of the interpolation along columns and rows whose rays leave through sides.
  double of_side_nodes(std::size_t count) const {
    CameraResolution resolution;
    resolution.side_nodes = count;
    LineSums columns(box_, true, resolution, 1), rows(box_, false, resolution, 1);
    double sum = 0;
    for (std::size_t e = 0; e < ends_.size(); ++e)
      for (LineSums* lines : {&columns, &rows})
        if (lines->reached(ends_[e].x)) sum += weights_[e] * lines->squared_error(ends_[e]) * size;
    return std::sqrt(sum / all_);
  }

 private:
  static constexpr std::size_t side = 16, size = side * side, most_ends = 3000;

  static FarCamera coarse(FarCamera camera) {
    camera.pixels = side;
    return camera;
  }
  static std::vector<double> pixel_coordinates(const FarCamera& camera) {
    std::vector<double> all;
    for (std::size_t i = 0; i < side; ++i) all.push_back(camera.cosine(0, i) / camera.aperture);
    return all;
  }
  /// Computes amplitudes with the attenuation up to the face.
  void find_values(const PathEnd& end, const Directions& directions,
                   std::span<Complex> value) const {
    for (std::size_t j = 0; j < value.size(); ++j)
      value[j] = std::exp(-box_.mu_t() * box_.depth_of(end.x) / std::abs(directions.z[j]) / 2);
    box_.walks().towards(end.x, end.arrival, directions, value);
  }
  void add_exact(const PathEnd& end, double weight) {
    std::vector<Complex> value(size);
    find_values(end, pixels_, value);
    exact_.insert(exact_.end(), value.begin(), value.end());
    for (std::size_t j = 0; j < size; ++j)
      value[j] = std::exp(-box_.mu_t() * box_.box().distance_to_edge(end.x, pixels_[j]) / 2);
    box_.walks().towards(end.x, end.arrival, pixels_, value);
    for (const Complex u : value) all_ += weight * std::norm(u);
  }

  const CameraBox box_;
  std::vector<double> grid_;
  Directions pixels_;
  std::vector<PathEnd> ends_;
  std::vector<double> weights_;
  std::vector<Complex> exact_;  ///< [end][pixel]
  double all_ = 0;              ///< sum of |exact field|^2
};

/// Returns the first of `counts` whose error is at most `accepted`, or the last; and its error.
template <typename Count, typename F>
std::pair<Count, double> least(std::initializer_list<Count> counts, double accepted, F error) {
  std::pair<Count, double> found;
  for (const Count count : counts) {
    found = {count, error(count)};
    if (found.second <= accepted) break;
  }
  return found;
}

}  // namespace

Scene on_coarse_camera(Scene scene) {
  constexpr std::size_t few = 8;
  CovarianceRequest& request = scene.request;
  FarCamera camera = request.camera.value();
  camera.pixels = std::min(few, camera.pixels);
  const auto kind = request.kind;
  request = intensity_request(request.lights, camera.views());
  request.kind = kind;
  if (kind == CovarianceRequest::Kind::full) request.entries.clear();
  request.camera = camera;
  return scene;
}

CameraResolution camera_resolution(const Scene& scene, const Plan& general, std::uint64_t seed,
                                   double tolerance, Vec margin) {
  constexpr std::uint64_t paths = 3000;
  Plan plan = plan_for_fields(general);
  plan.paths_per_batch = paths;
  const auto walks = path_walks(on_coarse_camera(scene), plan, seed);
  const CameraTrial trial(*walks, scene.request.camera.value(), seed);
  CameraResolution found;
  found.margin = margin;
  // Three axes
  const auto [width, by_width] =
      least<int>({4, 5, 6, 7, 8, 9, 10, 11, 12}, 0.5 * tolerance,
                 [&](int w) { return std::sqrt(3.0) * SpreadingAxis::error(w); });
  found.width = width;
  found.error = by_width;
  if (found.error > tolerance) return found;
  const auto [nodes, by_nodes] =
      least<std::size_t>({1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 12, 14, 16, 18, 20}, 0.5 * tolerance,
                         [&](std::size_t n) { return trial.of_nodes(n); });
  found.nodes = nodes;
  found.error = std::hypot(by_width, by_nodes);
  if (found.error > tolerance) return found;
  const auto [side_nodes, by_sides] =
      least<std::size_t>({2, 3, 4, 5, 6, 7, 8, 10, 12, 15, 20, 25, 30, 40}, 0.4 * tolerance,
                         [&](std::size_t n) { return trial.of_side_nodes(n); });
  found.side_nodes = side_nodes;
  found.error = std::hypot(by_width, by_nodes, by_sides);
  found.bytes = CameraSum::bytes({*walks, scene.request.camera.value()}, found);
  return found;
}

}  // namespace flatspeckle::mc
