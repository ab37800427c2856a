#include "mc/paths/speckle/camera_intensity.h"

#include <algorithm>

namespace flatspeckle::mc {

namespace {

/// Number of nodes of the intensity along each side of a camera. The intensity of one end has twice
/// the degree of its field, but the sum over many ends is smooth.
std::size_t intensity_nodes(const CameraResolution& resolution) {
  constexpr std::size_t most = 12;
  return std::min(most, 2 * resolution.nodes);
}

}  // namespace

CameraIntensity::CameraIntensity(const PathWalks& walks, const FarCamera& camera,
                                 const CameraResolution& resolution, std::size_t fields)
    : walks_(walks),
      camera_(camera),
      fields_(fields),
      node_(chebyshev_nodes(intensity_nodes(resolution))),
      values_(node_.size() * node_.size()),
      sums_(fields * values_.size()) {
  const Directions directions = CameraBox(walks, camera).square(node_);
  std::vector<Endpoint> endpoints;
  for (std::size_t j = 0; j < directions.size(); ++j)
    endpoints.push_back({false, directions[j], {}, 1, {}});
  factors_ = walks.factors(walks.scene(), endpoints, false);
}

void CameraIntensity::add(const PathEnd& end, std::span<const Complex> factors, std::size_t field) {
  factors_->attenuate(end.x, values_);
  walks_.towards(end.x, end.arrival, factors_->directions(), values_);
  for (std::size_t f = 0; f < factors.size(); ++f) {
    const double weight = std::norm(factors[f]);
    double* const to = &sums_[(field + f) * values_.size()];
    for (std::size_t j = 0; j < values_.size(); ++j) to[j] += weight * std::norm(values_[j]);
  }
}

void CameraIntensity::finish(std::span<double> out) const {
  const std::size_t pixels = camera_.pixels, count = node_.size();
  std::vector<std::vector<double>> at;
  for (std::size_t p = 0; p < pixels; ++p)
    at.push_back(lagrange(node_, camera_.cosine(0, p) / camera_.aperture));
  std::vector<double> row(count);
  for (std::size_t f = 0; f < fields_; ++f)
    for (std::size_t y = 0; y < pixels; ++y) {
      std::ranges::fill(row, 0);
      for (std::size_t b = 0; b < count; ++b)
        for (std::size_t a = 0; a < count; ++a)
          row[a] += at[y][b] * sums_[(f * count + b) * count + a];
      for (std::size_t x = 0; x < pixels; ++x) {
        double sum = 0;
        for (std::size_t a = 0; a < count; ++a) sum += at[x][a] * row[a];
        out[(f * pixels + y) * pixels + x] = std::max(0.0, sum);
      }
    }
}

}  // namespace flatspeckle::mc
