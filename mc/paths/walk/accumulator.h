#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/request/request.h"

namespace flatspeckle::mc {

/// Receives the fields f of sampled paths, one value per channel (pair of light and view). The mean
/// of weight f_a conj(f_b) over the paths of a batch estimates the covariance of channels a and b.
class Accumulator {
 public:
  virtual ~Accumulator() = default;
  virtual void add(double weight, std::span<const Complex> field) = 0;
};

/// Adds weight f_a conj(f_b) to the sum of every entry (a, b) of a request.
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

/// Accumulates the matrix of weight f f^H, summed over paths, where f is the vector of the fields
/// of all channels. The sums are its lower triangle, row by row. Fields are collected and then
/// added by Hermitian rank-k updates, so the matrix is positive semidefinite to rounding.
class RankKAccumulator : public Accumulator {
 public:
  RankKAccumulator(const CovarianceRequest& request, std::span<Complex> sums);

  void add(double weight, std::span<const Complex> field) override;
  /// Adds the collected fields to the sums.
  void finish();

 private:
  void update();

  std::size_t channels_;
  std::span<Complex> sums_;
  std::vector<Complex> collected_;  ///< columns sqrt(weight) f, one per path
  std::size_t columns_ = 0;
  std::vector<Complex> matrix_;  ///< column-major, lower triangle
};

}  // namespace flatspeckle::mc
