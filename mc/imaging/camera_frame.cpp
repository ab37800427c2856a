#include "mc/imaging/camera_frame.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <random>

namespace flatspeckle::mc {

namespace {

/// A stream as the distributions of the standard library want it.
struct Bits {
  using result_type = std::uint64_t;
  static constexpr result_type min() { return 0; }
  static constexpr result_type max() { return std::numeric_limits<result_type>::max(); }
  result_type operator()() { return stream.bits(); }
  RandomStream& stream;
};

}  // namespace

std::vector<double> sum_of_intensities(std::span<const Complex> field,
                                       std::span<const double> brightness) {
  const std::size_t pixels = field.size() / brightness.size();
  std::vector<double> frame(pixels);
  for (std::size_t n = 0; n < brightness.size(); ++n)
    for (std::size_t p = 0; p < pixels; ++p)
      frame[p] += brightness[n] * std::norm(field[n * pixels + p]);
  return frame;
}

std::vector<double> incoherent_sum(std::span<const Complex> field,
                                   std::span<const double> brightness) {
  auto frame = sum_of_intensities(field, brightness);
  const double mean = std::reduce(frame.begin(), frame.end()) / static_cast<double>(frame.size());
  if (mean > 0)
    for (double& value : frame) value /= mean;
  return frame;
}

void expose(std::vector<double>& frame, const CameraNoise& noise, RandomStream& random) {
  for (double& value : frame) value += noise.background;
  if (noise.photons == 0) return;
  Bits bits{random};
  std::normal_distribution<double> reading(0, 1);
  for (double& value : frame) {
    const double expected = std::max(value * noise.photons, 1e-300);
    const auto counted = static_cast<double>(std::poisson_distribution<long long>(expected)(bits));
    value = (counted + noise.read_noise * reading(bits)) / noise.photons;
  }
}

}  // namespace flatspeckle::mc
