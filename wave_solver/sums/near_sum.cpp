#include "wave_solver/sums/near_sum.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/run/parallel.h"

namespace flatspeckle::wave {

StripOrder::StripOrder(std::span<const Vec2> points, double height)
    : height_(height), order_(points.size()), first_{0}, z_(points.size()) {
  if (points.empty()) return;
  low_ =
      std::min_element(points.begin(), points.end(), [](Vec2 a, Vec2 b) { return a.x < b.x; })->x;
  std::vector<std::size_t> strip(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    strip[i] = static_cast<std::size_t>((points[i].x - low_) / height_);
  std::iota(order_.begin(), order_.end(), 0U);
  std::sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
    if (strip[a] != strip[b]) return strip[a] < strip[b];
    return points[a].z != points[b].z ? points[a].z < points[b].z : a < b;
  });
  first_.assign(strip[order_.back()] + 2, 0);
  for (const std::size_t s : strip) ++first_[s + 1];
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  for (std::size_t i = 0; i < order_.size(); ++i) z_[i] = points[order_[i]].z;
}

void StripOrder::around(Vec2 place, double distance, std::vector<Stretch>& stretches) const {
  const double own = (place.x - low_) / height_, reach = distance / height_;
  const auto strips = static_cast<double>(first_.size() - 1);
  const auto from = static_cast<std::size_t>(std::clamp(std::floor(own - reach), 0.0, strips));
  const auto to = static_cast<std::size_t>(std::clamp(std::floor(own + reach) + 1, 0.0, strips));
  for (std::size_t s = from; s < to; ++s) {
    const auto strip = static_cast<double>(s);
    const double apart = height_ * std::max({strip - own, own - strip - 1, 0.0});
    // A little more than the chord: rounding must not lose a pair.
    const double chord =
        std::sqrt(std::max(distance * distance - apart * apart, 0.0)) + 1e-6 * distance;
    const auto begin = z_.begin() + first_[s], end = z_.begin() + first_[s + 1];
    const auto low = std::lower_bound(begin, end, place.z - chord);
    const auto high = std::upper_bound(low, end, place.z + chord);
    if (low < high)
      stretches.push_back(
          {static_cast<std::uint32_t>(low - z_.begin()), static_cast<std::uint32_t>(high - low)});
  }
}

NearSum::NearSum(const KernelSplit& split, const StripOrder& strips, std::span<const Vec2> sources,
                 std::span<const Vec2> targets)
    : sources_(sources.size()), targets_(targets.size()) {
  constexpr std::size_t block_size = 256;
  for (std::size_t first = 0; first < targets_; first += block_size)
    blocks_.emplace_back(first, std::min(block_size, targets_ - first));
  parallel_for(blocks_.size(),
               [&](std::size_t b) { fill(blocks_[b], split, strips, sources, targets); });
}

void NearSum::fill(Block& block, const KernelSplit& split, const StripOrder& strips,
                   std::span<const Vec2> sources, std::span<const Vec2> targets) const {
  std::vector<double> distance;
  for (std::size_t i = block.first; i < block.first + block.count; ++i) {
    const std::size_t before = block.sources.size();
    strips.around(targets[i], split.range(), block.sources);
    block.stretches.push_back(static_cast<std::uint32_t>(block.sources.size() - before));
    for (std::size_t s = before; s < block.sources.size(); ++s)
      for (std::uint32_t n = 0; n < block.sources[s].count; ++n) {
        const std::uint32_t j = block.sources[s].first + n;
        distance.push_back(length(sources[strips.order()[j]] - targets[i]));
        if (distance.back() == 0) block.coincident.emplace_back(static_cast<std::uint32_t>(i), j);
      }
  }
  block.values.resize(distance.size());
  split.near(distance, block.values);
}

void NearSum::add(std::span<const Complex> charges, std::span<Complex> sums) const {
  if (sources_ == 0) return;
  const std::size_t columns = charges.size() / sources_;
  std::vector<double> re(charges.size()), im(charges.size());
  for (std::size_t i = 0; i < charges.size(); ++i) {
    re[i] = charges[i].real();
    im[i] = charges[i].imag();
  }
  parallel_for(blocks_.size(), targets_ * columns > 10000, [&](std::size_t b) {
    const Block& block = blocks_[b];
    for (std::size_t column = 0; column < columns; ++column) {
      const double* q_re = &re[column * sources_];
      const double* q_im = &im[column * sources_];
      const double* value = block.values.data();
      auto stretch = block.sources.begin();
      for (std::size_t i = 0; i < block.count; ++i) {
        double sum_re = 0, sum_im = 0;
        for (std::uint32_t s = 0; s < block.stretches[i]; ++s, ++stretch) {
#pragma omp simd reduction(+ : sum_re, sum_im)
          for (std::uint32_t n = 0; n < stretch->count; ++n) {
            sum_re += value[n] * q_re[stretch->first + n];
            sum_im += value[n] * q_im[stretch->first + n];
          }
          value += stretch->count;
        }
        sums[column * targets_ + block.first + i] += Complex(-sum_im, sum_re);
      }
      for (const auto& [i, j] : block.coincident)
        sums[column * targets_ + i] -= charges[column * sources_ + j];
    }
  });
}

}  // namespace flatspeckle::wave
