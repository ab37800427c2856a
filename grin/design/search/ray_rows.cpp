#include "grin/design/search/ray_rows.h"

#include <algorithm>

#include "core/run/parallel.h"

namespace flatspeckle::grin::design {

namespace {

constexpr std::size_t shares = 8;  // of the blocks, each summed up by itself

/// use(ray in the block, begin, end) of each.
template <class Use>
void each_ray(const RayRows::Block& block, const Use& use) {
  std::size_t begin = 0;
  for (std::size_t r = 0; r < block.end.size(); ++r) {
    use(r, begin, block.end[r]);
    begin = block.end[r];
  }
}

}  // namespace

RayRows::RayRows(std::size_t rays, int readings, std::size_t coefficients)
    : readings_(readings),
      coefficients_(coefficients),
      blocks_((rays + block_size - 1) / block_size) {}

void RayRows::times(std::span<const double> coefficients, std::span<double> readings) const {
  parallel_for(blocks_.size(), [&](std::size_t b) {
    const Block& block = blocks_[b];
    each_ray(block, [&](std::size_t r, std::size_t begin, std::size_t end) {
      double sums[2] = {};
      for (std::size_t i = begin; i < end; ++i)
        for (std::size_t k = 0; k < readings_; ++k)
          sums[k] += block.values[i * readings_ + k] * coefficients[block.index[i]];
      std::copy_n(sums, readings_, &readings[(b * block_size + r) * readings_]);
    });
  });
}

/// add(block, its first ray, sums): sums of the blocks of a share in turn, then of the shares.
template <class Add>
void RayRows::sum_up(std::span<double> coefficients, const Add& add) const {
  std::vector<std::vector<double>> sums(shares);
  parallel_for(shares, [&](std::size_t s) {
    sums[s].assign(coefficients_, 0.0);
    for (std::size_t b = s * blocks_.size() / shares; b < (s + 1) * blocks_.size() / shares; ++b)
      add(blocks_[b], b * block_size, sums[s]);
  });
  std::fill(coefficients.begin(), coefficients.end(), 0.0);
  for (const auto& share : sums)
    for (std::size_t i = 0; i < coefficients_; ++i) coefficients[i] += share[i];
}

void RayRows::transposed(std::span<const double> readings, std::span<double> coefficients) const {
  sum_up(coefficients, [&](const Block& block, std::size_t first, std::vector<double>& sums) {
    each_ray(block, [&](std::size_t r, std::size_t begin, std::size_t end) {
      const double* of_ray = &readings[(first + r) * readings_];
      for (std::size_t i = begin; i < end; ++i)
        for (std::size_t k = 0; k < readings_; ++k)
          sums[block.index[i]] += block.values[i * readings_ + k] * of_ray[k];
    });
  });
}

void RayRows::squares(std::span<const double> weights, std::span<double> coefficients) const {
  sum_up(coefficients, [&](const Block& block, std::size_t first, std::vector<double>& sums) {
    each_ray(block, [&](std::size_t r, std::size_t begin, std::size_t end) {
      const double* of_ray = &weights[(first + r) * readings_];
      for (std::size_t i = begin; i < end; ++i)
        for (std::size_t k = 0; k < readings_; ++k) {
          const double value = block.values[i * readings_ + k] * of_ray[k];
          sums[block.index[i]] += value * value;
        }
    });
  });
}

double RayRows::bytes() const {
  double bytes = 0;
  for (const Block& block : blocks_)
    bytes += static_cast<double>(block.index.capacity() * sizeof(std::uint32_t) +
                                 block.values.capacity() * sizeof(float));
  return bytes;
}

}  // namespace flatspeckle::grin::design
