#include "grin/design/system/ray_rows.h"

#include <algorithm>
#include <type_traits>

#include "core/run/parallel.h"

namespace flatspeckle::grin::design {

namespace {

constexpr std::size_t shares = 8;  // of the blocks, each summed up by itself
constexpr std::size_t width = RayRows::width;
using Block = RayRows::Block;

/// Of a ray, in its block.
struct Fours {
  std::size_t begin, end;
};

/// use(ray in the block, its fours) of each.
template <class Use>
void each_ray(const Block& block, const Use& use) {
  std::size_t begin = 0;
  for (std::size_t r = 0; r < block.end.size(); ++r) {
    use(r, Fours{begin, block.end[r]});
    begin = block.end[r];
  }
}

/// With room for the last four.
std::vector<double> padded(std::span<const double> coefficients) {
  std::vector<double> values(coefficients.begin(), coefficients.end());
  values.resize(values.size() + width - 1);
  return values;
}

template <std::size_t K>
std::array<double, K> read(const Block& block, const Fours& fours, const double* coefficients) {
  std::array<std::array<double, width>, K> sums{};
  for (std::size_t i = fours.begin; i < fours.end; ++i) {
    const double* const at = coefficients + block.index[i];
    const float* const values = &block.values[i * K * width];
    for (std::size_t k = 0; k < K; ++k)
      for (std::size_t j = 0; j < width; ++j)
        sums[k][j] += static_cast<double>(values[k * width + j]) * at[j];
  }
  std::array<double, K> readings;
  for (std::size_t k = 0; k < K; ++k)
    readings[k] = (sums[k][0] + sums[k][1]) + (sums[k][2] + sums[k][3]);
  return readings;
}

template <std::size_t K>
void add_transposed(const Block& block, const Fours& fours, const double* of_ray, double* sums) {
  for (std::size_t i = fours.begin; i < fours.end; ++i) {
    double* const at = sums + block.index[i];
    const float* const values = &block.values[i * K * width];
    std::array<double, width> sum{};
    for (std::size_t k = 0; k < K; ++k)
      for (std::size_t j = 0; j < width; ++j)
        sum[j] += of_ray[k] * static_cast<double>(values[k * width + j]);
    for (std::size_t j = 0; j < width; ++j) at[j] += sum[j];
  }
}

template <std::size_t K>
void add_squares(const Block& block, const Fours& fours, const double* weights, double* sums) {
  for (std::size_t i = fours.begin; i < fours.end; ++i)
    for (std::size_t k = 0; k < K; ++k)
      for (std::size_t j = 0; j < width; ++j) {
        const double value = block.values[(i * K + k) * width + j] * weights[k];
        sums[block.index[i] + j] += value * value;
      }
}

}  // namespace

RayRows::RayRows(std::size_t rays, int readings, std::size_t coefficients)
    : readings_(readings),
      coefficients_(coefficients),
      blocks_((rays + block_size - 1) / block_size) {}

/// use(K) of the type that says how many readings there are.
template <class Use>
void RayRows::of_readings(const Use& use) const {
  if (readings_ == 1) return use(std::integral_constant<std::size_t, 1>());
  use(std::integral_constant<std::size_t, 2>());
}

/// add(block, its first ray, sums): sums of the blocks of a share in turn, then of the shares.
template <class Add>
void RayRows::sum_up(std::span<double> coefficients, const Add& add) const {
  std::vector<std::vector<double>> sums(shares);
  parallel_for(shares, [&](std::size_t s) {
    sums[s].assign(coefficients_ + width - 1, 0.0);
    for (std::size_t b = s * blocks_.size() / shares; b < (s + 1) * blocks_.size() / shares; ++b)
      add(blocks_[b], b * block_size, sums[s].data());
  });
  std::fill(coefficients.begin(), coefficients.end(), 0.0);
  for (const auto& share : sums)
    for (std::size_t i = 0; i < coefficients_; ++i) coefficients[i] += share[i];
}

void RayRows::times(std::span<const double> coefficients, std::span<double> readings) const {
  const auto values = padded(coefficients);
  of_readings([&]<std::size_t K>(std::integral_constant<std::size_t, K>) {
    parallel_for(blocks_.size(), [&](std::size_t b) {
      each_ray(blocks_[b], [&](std::size_t r, const Fours& fours) {
        std::ranges::copy(read<K>(blocks_[b], fours, values.data()),
                          &readings[(b * block_size + r) * K]);
      });
    });
  });
}

void RayRows::transposed(std::span<const double> readings, std::span<double> coefficients) const {
  of_readings([&]<std::size_t K>(std::integral_constant<std::size_t, K>) {
    sum_up(coefficients, [&](const Block& block, std::size_t first, double* sums) {
      each_ray(block, [&](std::size_t r, const Fours& fours) {
        add_transposed<K>(block, fours, &readings[(first + r) * K], sums);
      });
    });
  });
}

void RayRows::normal(std::span<const double> coefficients, std::span<double> result) const {
  const auto values = padded(coefficients);
  of_readings([&]<std::size_t K>(std::integral_constant<std::size_t, K>) {
    sum_up(result, [&](const Block& block, std::size_t, double* sums) {
      each_ray(block, [&](std::size_t, const Fours& fours) {
        const auto readings = read<K>(block, fours, values.data());
        add_transposed<K>(block, fours, readings.data(), sums);
      });
    });
  });
}

void RayRows::squares(std::span<const double> weights, std::span<double> coefficients) const {
  of_readings([&]<std::size_t K>(std::integral_constant<std::size_t, K>) {
    sum_up(coefficients, [&](const Block& block, std::size_t first, double* sums) {
      each_ray(block, [&](std::size_t r, const Fours& fours) {
        add_squares<K>(block, fours, &weights[(first + r) * K], sums);
      });
    });
  });
}

}  // namespace flatspeckle::grin::design
