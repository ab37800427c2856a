#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include <Random123/threefry.h>

namespace flatspeckle {

/// Counter-based random numbers (Random123, Threefry4x64-20 [salmon2011]): the key of the generator
/// is (seed, stream), and its counter is (index of the block of four numbers, batch). The random
/// numbers of a batch depend only on seed, stream and batch, never on threads or other batches.
class RandomStream {
 public:
  RandomStream(std::uint64_t seed, std::uint64_t stream, std::uint64_t batch)
      : key_{{seed, stream, 0, 0}}, counter_{{0, batch, 0, 0}} {}

  std::uint64_t bits() {
    if (used_ == block_.size()) refill();
    return block_.v[used_++];
  }

  /// Makes the next call of uniform() return u, in (0, 1), before the stream continues; used for
  /// numbers that are stratified over many streams.
  void put_back(double u) { block_.v[--used_] = bits_of(u); }
  /// Makes the next four calls of uniform() return these numbers, in (0, 1), before the stream
  /// continues with its next block; used for points that are stratified over many paths.
  void lead(const std::array<double, 4>& u) {
    for (used_ = 4; used_ > 0;) put_back(u[used_ - 1]);
  }
  std::uint64_t seed() const { return key_.v[0]; }
  std::uint64_t batch() const { return counter_.v[1]; }

  /// Returns a random number u, uniformly distributed in the open interval (0, 1), so that log(u),
  /// log(1 - u) and 1/u are finite.
  double uniform() { return uniform(bits()); }
  /// Converts random bits to a number in (0, 1): an odd multiple of 2^-54, rounded to double if it
  /// is above 1/2. The minimum is taken because 1 - 2^-54 would be rounded to 1.
  static double uniform(std::uint64_t bits) {
    return std::min((static_cast<double>(bits >> 11) + 0.5) * 0x1p-53, 1 - 0x1p-53);
  }

 private:
  static std::uint64_t bits_of(double u) { return static_cast<std::uint64_t>(u * 0x1p53) << 11; }
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

/// Independent random streams of one seed, one for each purpose.
enum class Stream : std::uint64_t {
  placement = 1,
  light_paths = 2,
  fields = 3,
  render = 4,
  light_map = 5,
  camera = 7
};

}  // namespace flatspeckle
