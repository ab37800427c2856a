#include "grin/design/roughness.h"

namespace flatspeckle::grin::design {

/// use(first of three coefficients in a line, how far apart they are)
template <class Use>
void Roughness::each_difference(const Use& use) const {
  const auto [nx, ny, nz] = shape_.extent;
  const std::size_t stride[3] = {static_cast<std::size_t>(ny) * nz, static_cast<std::size_t>(nz),
                                 1};
  for (int axis = 0; axis < 3; ++axis) {
    std::array<int, 3> end = shape_.extent;
    end[axis] -= 2;
    for (int i = 0; i < end[0]; ++i)
      for (int j = 0; j < end[1]; ++j)
        for (int k = 0; k < end[2]; ++k) use(i * stride[0] + j * stride[1] + k, stride[axis]);
  }
}

void Roughness::add_times(std::span<const double> values, double weight,
                          std::span<double> sums) const {
  each_difference([&](std::size_t first, std::size_t apart) {
    const double difference =
        weight * (values[first] - 2 * values[first + apart] + values[first + 2 * apart]);
    sums[first] += difference;
    sums[first + apart] -= 2 * difference;
    sums[first + 2 * apart] += difference;
  });
}

void Roughness::add_diagonal(double weight, std::span<double> sums) const {
  each_difference([&](std::size_t first, std::size_t apart) {
    sums[first] += weight;
    sums[first + apart] += 4 * weight;
    sums[first + 2 * apart] += weight;
  });
}

double Roughness::square(std::span<const double> values) const {
  double sum = 0;
  each_difference([&](std::size_t first, std::size_t apart) {
    const double difference = values[first] - 2 * values[first + apart] + values[first + 2 * apart];
    sum += difference * difference;
  });
  return sum;
}

}  // namespace flatspeckle::grin::design
