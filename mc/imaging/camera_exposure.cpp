#include "mc/imaging/camera_exposure.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "core/error.h"

namespace flatspeckle::mc {

namespace {

/// Adapts a RandomStream to the distributions of the standard library.
struct Bits {
  using result_type = std::uint64_t;
  static constexpr result_type min() { return 0; }
  static constexpr result_type max() { return std::numeric_limits<result_type>::max(); }
  result_type operator()() { return stream.bits(); }
  RandomStream& stream;
};

}  // namespace

double Detector::step() const {
  return bit_depth > 0 ? full_well / (std::exp2(static_cast<double>(bit_depth)) - 1) : 1;
}

void add_keys(Keys& keys, Detector& detector) {
  keys.add("quantum_efficiency", detector.quantum_efficiency,
           "Probability that a photon is detected, as an electron")
      .positive_to(1)
      .only_of("photons with dimension = 3");
  keys.add("full_well", detector.full_well,
           "Electrons at which a pixel of the camera saturates (default 0: never)")
      .not_negative()
      .only_of("photons with dimension = 3");
  keys.add("bit_depth", detector.bit_depth,
           "Bits of the camera's values, the largest of which is full_well (default 0: electrons)")
      .from(0, 32)
      .only_of("photons with dimension = 3");
}

Detector detector_of(const Keys& keys, const Detector& detector, const CameraNoise& noise) {
  if (noise.photons == 0) return {};
  Detector read{keys.read(detector.quantum_efficiency), keys.read(detector.full_well),
                keys.read(detector.bit_depth)};
  if (read.bit_depth > 0 && read.full_well == 0)
    throw InputError("bit_depth", read.bit_depth, "requires full_well, the largest value");
  return read;
}

CameraNoise detected_noise(const CameraNoise& noise, const Detector& detector) {
  if (noise.photons == 0) return noise;
  CameraNoise found = noise;
  found.photons *= detector.quantum_efficiency;
  // Rounding to multiples of the step has the variance step^2 / 12
  if (detector.bit_depth > 0)
    found.read_noise = std::hypot(noise.read_noise, detector.step() / std::sqrt(12.0));
  return found;
}

std::size_t detect(std::vector<double>& frame, const CameraNoise& noise, const Detector& detector,
                   RandomStream& random) {
  for (double& value : frame) value += noise.background;
  if (noise.photons == 0) return 0;
  Bits bits{random};
  std::normal_distribution<double> reading(0, 1);
  const double electrons = noise.photons * detector.quantum_efficiency, step = detector.step();
  std::size_t saturated = 0;
  for (double& value : frame) {
    const double expected = std::max(value * electrons, 1e-300);
    const auto counted = static_cast<double>(std::poisson_distribution<long long>(expected)(bits));
    value = counted + noise.read_noise * reading(bits);
    if (detector.full_well > 0 && value >= detector.full_well) {
      value = detector.full_well;
      ++saturated;
    }
    if (detector.bit_depth > 0) value = std::round(std::max(value, 0.0) / step);
  }
  return saturated;
}

void expose(std::vector<double>& frame, const CameraNoise& noise, RandomStream& random) {
  detect(frame, noise, {}, random);
  if (noise.photons > 0)
    for (double& value : frame) value /= noise.photons;
}

}  // namespace flatspeckle::mc
