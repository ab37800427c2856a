#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/request/request.h"

namespace flatspeckle::mc {

/// What takes the fields of sampled paths: the mean of weight f_a conj(f_b) over the paths of a
/// batch is the covariance of channels a and b.
class Accumulator {
 public:
  virtual ~Accumulator() = default;
  virtual void add(double weight, std::span<const Complex> field) = 0;
};

/// Adds weight f_a conj(f_b) for the entries of a list.
class EntryAccumulator : public Accumulator {
 public:
  EntryAccumulator(const CovarianceRequest& request, std::span<Complex> sums);

  void add(double weight, std::span<const Complex> field) override;
  void finish() {}

 private:
  struct Term {
    Entry entry;
    std::uint32_t sum;
  };
  std::vector<Term> intensities_, others_;
  std::span<Complex> sums_;
};

/// The lower triangle of sum weight f f^H over all channels, row by row: fields are collected and
/// merged by Hermitian rank-k updates, so the sum is positive semidefinite to rounding.
class RankKAccumulator : public Accumulator {
 public:
  RankKAccumulator(const CovarianceRequest& request, std::span<Complex> sums);

  void add(double weight, std::span<const Complex> field) override;
  /// Adds what was collected to the sums.
  void finish();

 private:
  void update();

  std::size_t channels_;
  std::span<Complex> sums_;
  std::vector<Complex> collected_;  ///< columns sqrt(weight) f
  std::size_t columns_ = 0;
  std::vector<Complex> matrix_;  ///< column-major, lower triangle
};

}  // namespace flatspeckle::mc
