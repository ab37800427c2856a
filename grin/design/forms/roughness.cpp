#include "grin/design/forms/roughness.h"

namespace flatspeckle::grin::design {

namespace {

/// Third differences: they are small where a field is smooth over some cells, also where it bends.
constexpr std::array<double, 4> stencil{-1, 3, -3, 1};
constexpr int reach = stencil.size() - 1;

double difference(std::span<const double> values, std::size_t first, std::size_t apart) {
  double sum = 0;
  for (std::size_t i = 0; i < stencil.size(); ++i) sum += stencil[i] * values[first + i * apart];
  return sum;
}

}  // namespace

/// use(first of those in a line, how far apart they are)
template <class Use>
void Roughness::each_difference(const Use& use) const {
  const auto [nx, ny, nz] = shape_.extent;
  const std::size_t stride[3] = {static_cast<std::size_t>(ny) * nz, static_cast<std::size_t>(nz),
                                 1};
  for (int axis = 0; axis < 3; ++axis) {
    std::array<int, 3> end = shape_.extent;
    end[axis] -= reach;
    for (int i = 0; i < end[0]; ++i)
      for (int j = 0; j < end[1]; ++j)
        for (int k = 0; k < end[2]; ++k) use(i * stride[0] + j * stride[1] + k, stride[axis]);
  }
}

void Roughness::add_times(std::span<const double> values, double weight,
                          std::span<double> sums) const {
  each_difference([&](std::size_t first, std::size_t apart) {
    const double weighted = weight * difference(values, first, apart);
    for (std::size_t i = 0; i < stencil.size(); ++i)
      sums[first + i * apart] += stencil[i] * weighted;
  });
}

void Roughness::add_diagonal(double weight, std::span<double> sums) const {
  each_difference([&](std::size_t first, std::size_t apart) {
    for (std::size_t i = 0; i < stencil.size(); ++i)
      sums[first + i * apart] += stencil[i] * stencil[i] * weight;
  });
}

double Roughness::square(std::span<const double> values) const {
  double sum = 0;
  each_difference([&](std::size_t first, std::size_t apart) {
    const double d = difference(values, first, apart);
    sum += d * d;
  });
  return sum;
}

}  // namespace flatspeckle::grin::design
