#include "wave_solver/periodic/shaped_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "wave_solver/dense/blas.h"

namespace flatspeckle::wave {

void add_focus(const std::vector<Complex>& t, std::size_t n, std::size_t segments,
               std::span<Complex, 2> sums) {
  for (std::size_t b = 0; b < n; ++b) {
    std::vector<Complex> fields(segments);
    for (std::size_t a = 0; a < n; ++a) fields[a * segments / n] += t[b + n * a];
    double amplitude = 0;
    for (const Complex field : fields) {
      amplitude += std::abs(field);
      sums[1] += std::norm(field);
    }
    sums[0] += amplitude * amplitude;
  }
}

double expected_focus(const std::vector<double>& transmittance, std::size_t segments) {
  const std::size_t n = transmittance.size();
  std::vector<double> groups(segments);
  for (std::size_t a = 0; a < n; ++a) groups[a * segments / n] += transmittance[a];
  double amplitudes = 0, powers = 0;
  for (const double power : groups) {
    amplitudes += std::sqrt(power);
    powers += power;
  }
  return 1 + std::numbers::pi / 4 * (amplitudes * amplitudes / powers - 1);
}

std::size_t recorded_channels(double fraction, std::size_t n) {
  return std::max<std::size_t>(1, std::lround(fraction * static_cast<double>(n)));
}

void add_conjugation(const std::vector<Complex>& t, std::size_t n, std::size_t recorded,
                     std::span<Complex, 2> sums) {
  const Complex* const part = &t[(n - recorded) / 2];
  std::vector<Complex> returned(n * n);
  multiply(CblasConjTrans, CblasNoTrans, n, n, recorded, 1, part, n, part, n, 0, returned.data(),
           n);
  for (std::size_t a = 0; a < n; ++a) sums[0] += std::norm(returned[a + n * a]);
  for (const Complex amplitude : returned) sums[1] += std::norm(amplitude);
}

double expected_conjugation(const std::vector<double>& transmittance, std::size_t recorded) {
  const auto sums = [](std::span<const double> of) {
    double sum = 0, squares = 0;
    for (const double value : of) {
      sum += value;
      squares += value * value;
    }
    return std::pair(sum, squares);
  };
  const auto [g, all_squares] = sums(transmittance);
  const auto [part, squares] =
      sums(std::span(transmittance).subspan((transmittance.size() - recorded) / 2, recorded));
  const double alike = all_squares / (g * g);  // sum of w_a^2, if that of w_a is 1
  const double correlation = (2 * g / 3 - 2 * all_squares) / (g * g);
  const double focus = alike * ((1 + correlation) * part * part + squares);
  return focus / ((alike + correlation) * part * part + squares);
}

}  // namespace flatspeckle::wave
