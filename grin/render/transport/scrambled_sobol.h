#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "core/numbers/random.h"

namespace flatspeckle::grin {

/// Sobol points in four dimensions (direction numbers of Joe and Kuo [joe2008]) with an Owen
/// scrambling by hashes (Burley [burley2020], practical hash-based Owen scrambling). The first 2^m
/// points of a sequence are stratified over the square of the first two coordinates, and each
/// coordinate has one point in each of 2^m equal intervals. A point depends only on seed, sequence
/// and its number.
class ScrambledSobol {
 public:
  ScrambledSobol(std::uint64_t seed, std::uint64_t sequence) {
    const std::uint64_t own = mixed(mixed(seed) ^ sequence);
    for (std::size_t stream = 0; stream < keys_.size(); ++stream) keys_[stream] = mixed(own + stream);
  }

  /// Returns point `number`, in (0, 1)^4.
  std::array<double, 4> point(std::uint64_t number) const {
    // the order of the points is scrambled too, so that points of two sequences do not go together
    const std::uint32_t index =
        reversed(scrambled(reversed(static_cast<std::uint32_t>(number)), keys_[0]));
    const Coordinates sobol = reversed_sobol(index);
    std::array<double, 4> point;
    for (std::size_t axis = 0; axis < 4; ++axis)
      point[axis] = (reversed(scrambled(sobol[axis], keys_[axis + 1])) + 0.5) * 0x1p-32;
    return point;
  }

 private:
  /// Finalizer of SplitMix64 [steele2014].
  static constexpr std::uint64_t mixed(std::uint64_t x) {
    x += 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
  }
  static std::uint32_t reversed(std::uint32_t x) {
    x = __builtin_bswap32(x);
    x = (x & 0x0f0f0f0fu) << 4 | (x >> 4 & 0x0f0f0f0fu);
    x = (x & 0x33333333u) << 2 | (x >> 2 & 0x33333333u);
    return (x & 0x55555555u) << 1 | (x >> 1 & 0x55555555u);
  }
  /// Applies a random permutation in which each bit depends only on itself and lower bits. Read
  /// from the lowest bit, this is a nested uniform scrambling.
  static std::uint32_t scrambled(std::uint32_t x, std::uint64_t key) {
    const auto low = static_cast<std::uint32_t>(key), high = static_cast<std::uint32_t>(key >> 32);
    x += low;
    x ^= x * (high & ~1u);
    x += high;
    x ^= x * (low & ~1u);
    return x * ((low ^ high) | 1u);
  }

  using Coordinates = std::array<std::uint32_t, 4>;
  /// Direction numbers [axis][bit of the index], with bits in reversed order.
  using Directions = std::array<std::array<std::uint32_t, 32>, 4>;
  static constexpr Directions directions() {
    struct Polynomial {
      int degree;
      unsigned middle;            ///< coefficients between the first and the last
      std::array<unsigned, 3> m;  ///< initial numbers
    };
    constexpr Polynomial polynomials[] = {{1, 0, {1}}, {2, 1, {1, 3}}, {3, 1, {1, 3, 1}}};
    Directions all{};
    for (int bit = 0; bit < 32; ++bit) all[0][bit] = 1u << bit;
    for (int axis = 1; axis < 4; ++axis) {
      const Polynomial& of = polynomials[axis - 1];
      std::array<std::uint32_t, 32> v{};  // highest bit: 1/2
      for (int i = 0; i < 32; ++i) {
        if (i < of.degree) {
          v[i] = of.m[i] << (31 - i);
          continue;
        }
        v[i] = v[i - of.degree] ^ (v[i - of.degree] >> of.degree);
        for (int k = 1; k < of.degree; ++k)
          if (of.middle >> (of.degree - 1 - k) & 1u) v[i] ^= v[i - k];
      }
      for (int i = 0; i < 32; ++i)
        for (int bit = 0; bit < 32; ++bit) all[axis][i] |= (v[i] >> bit & 1u) << (31 - bit);
    }
    return all;
  }
  /// Sums of direction numbers [byte of the index][its value].
  using ByteSums = std::array<std::array<Coordinates, 256>, 4>;
  static constexpr ByteSums byte_sums() {
    const Directions v = directions();
    ByteSums sums{};
    for (unsigned byte = 0; byte < 4; ++byte)
      for (unsigned value = 1; value < 256; ++value) {
        const int lowest = std::countr_zero(value);
        for (std::size_t axis = 0; axis < 4; ++axis)
          sums[byte][value][axis] =
              sums[byte][value & (value - 1)][axis] ^ v[axis][8 * byte + lowest];
      }
    return sums;
  }
  /// Returns the coordinates of Sobol point `index`, with bits in reversed order.
  static Coordinates reversed_sobol(std::uint32_t index) {
    static constexpr ByteSums sums = byte_sums();
    Coordinates x{};
    for (unsigned byte = 0; byte < 4; ++byte)
      for (std::size_t axis = 0; axis < 4; ++axis)
        x[axis] ^= sums[byte][index >> 8 * byte & 0xffu][axis];
    return x;
  }

  std::array<std::uint64_t, 5> keys_;  ///< of the order, and of each axis
};

/// Returns the points by which the first random numbers of the light paths of a batch are
/// stratified. random: random stream of the batch.
inline ScrambledSobol light_points(const RandomStream& random) {
  return {random.seed(), ~random.batch()};
}

}  // namespace flatspeckle::grin
