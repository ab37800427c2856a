#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include <Random123/threefry.h>

namespace flatspeckle {

/// Addressed random numbers (Random123, Threefry4x64-20): the key is (seed, stream), the counter is
/// (draw block, batch). The numbers of a batch depend on these alone, never on threads or on what
/// was drawn before.
class RandomStream {
 public:
  RandomStream(std::uint64_t seed, std::uint64_t stream, std::uint64_t batch)
      : key_{{seed, stream, 0, 0}}, counter_{{0, batch, 0, 0}} {}

  std::uint64_t bits() {
    if (used_ == block_.size()) refill();
    return block_.v[used_++];
  }

  /// The next uniform() is u, in (0, 1): of numbers that are drawn evenly for many streams.
  void put_back(double u) { block_.v[--used_] = static_cast<std::uint64_t>(u * 0x1p53) << 11; }

  /// Uniform in the open interval (0, 1), so that log(u), log(1 - u) and 1/u are finite.
  double uniform() { return uniform(bits()); }
  /// Odd multiples of 2^-54, rounded above 1/2: 1 - 2^-54 to 1, but for the bound.
  static double uniform(std::uint64_t bits) {
    return std::min((static_cast<double>(bits >> 11) + 0.5) * 0x1p-53, 1 - 0x1p-53);
  }

 private:
  void refill() {
    block_ = engine_(counter_, key_);
    ++counter_.v[0];
    used_ = 0;
  }

  r123::Threefry4x64 engine_;
  r123::Threefry4x64::key_type key_;
  r123::Threefry4x64::ctr_type counter_;
  r123::Threefry4x64::ctr_type block_{};
  std::size_t used_ = 4;
};

/// Streams of one seed; each use of randomness has its own.
enum class Stream : std::uint64_t {
  placement = 1,
  light_paths = 2,
  fields = 3,
  render = 4,
  light_map = 5,
  camera = 7
};

}  // namespace flatspeckle
