#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace flatspeckle::grin::design {

/// Derivatives of what is read off rays by the coefficients: K rows of each ray, at the same
/// coefficients. All sums are made in an order that does not depend on the threads.
class RayRows {
 public:
  RayRows() = default;
  RayRows(std::size_t rays, int readings, std::size_t coefficients);

  /// Rays of a block, to be filled in their order.
  static constexpr std::size_t block_size = 32;
  std::size_t blocks() const { return blocks_.size(); }
  struct Block {
    std::vector<std::uint32_t> index;
    std::vector<float> values;     ///< K of each
    std::vector<std::size_t> end;  ///< of each ray in index
  };
  Block& block(std::size_t b) { return blocks_[b]; }

  /// readings[ray K + k] = row . coefficients
  void times(std::span<const double> coefficients, std::span<double> readings) const;
  /// coefficients = sum of rows times readings
  void transposed(std::span<const double> readings, std::span<double> coefficients) const;
  /// Sum of the squares of each column, weighted by those of the readings.
  void squares(std::span<const double> weights, std::span<double> coefficients) const;
  double bytes() const;

 private:
  template <class Add>
  void sum_up(std::span<double> coefficients, const Add& add) const;

  std::size_t readings_ = 1, coefficients_ = 0;
  std::vector<Block> blocks_;
};

}  // namespace flatspeckle::grin::design
