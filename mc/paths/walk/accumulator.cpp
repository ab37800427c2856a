#include "mc/paths/walk/accumulator.h"

#include <algorithm>
#include <cmath>

#include "core/numbers/blas.h"

namespace flatspeckle::mc {

namespace {
constexpr std::size_t columns_at_once = 128;
}

EntryAccumulator::EntryAccumulator(const CovarianceRequest& request, std::span<Complex> sums)
    : sums_(sums) {
  for (std::uint32_t e = 0; e < request.entries.size(); ++e) {
    const Entry entry = request.entries[e];
    (entry.a == entry.b ? intensities_ : others_).push_back({entry, e});
  }
}

void EntryAccumulator::add(double weight, std::span<const Complex> field) {
  for (const auto& [entry, sum] : intensities_) sums_[sum] += weight * std::norm(field[entry.a]);
  for (const auto& [entry, sum] : others_)
    sums_[sum] += weight * product_with_conjugate(field[entry.a], field[entry.b]);
}

RankKAccumulator::RankKAccumulator(const CovarianceRequest& request, std::span<Complex> sums)
    : channels_(request.channels.size()),
      sums_(sums),
      collected_(channels_ * columns_at_once),
      matrix_(channels_ * channels_) {
  blas_single_thread();
}

void RankKAccumulator::add(double weight, std::span<const Complex> field) {
  const double scale = std::sqrt(weight);
  std::transform(field.begin(), field.end(), collected_.begin() + columns_ * channels_,
                 [scale](Complex f) { return scale * f; });
  if (++columns_ == columns_at_once) update();
}

void RankKAccumulator::update() {
  const auto n = blas_size(channels_);
  cblas_zherk(CblasColMajor, CblasLower, CblasNoTrans, n, blas_size(columns_), 1.0,
              collected_.data(), n, 1.0, matrix_.data(), n);
  columns_ = 0;
}

void RankKAccumulator::finish() {
  update();
  std::size_t entry = 0;
  for (std::size_t a = 0; a < channels_; ++a)
    for (std::size_t b = 0; b <= a; ++b) sums_[entry++] += matrix_[a + b * channels_];
}

}  // namespace flatspeckle::mc
