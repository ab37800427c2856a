#pragma once

#include <bit>
#include <cstdint>

namespace flatspeckle {

// Elementary functions without branches, so that the compiler can vectorise loops that call them.

/// Returns e^x with a relative error of 2e-16. For x < -708 it returns e^-708 = 3e-308.
inline double wide_exp(double x) {
  // Adding `shift` rounds a number to an integer, which is then in the low bits of the sum.
  constexpr double shift = 0x1.8p52;
  x = x < -708 ? -708 : x;
  const double shifted = x * 0x1.71547652b82fep0 + shift, n = shifted - shift;
  const double r = (x - n * 0x1.62e42fefa0000p-1) - n * 0x1.cf79abc9e3b3ap-40;
  double sum = 1 / 6227020800.;
  sum = sum * r + 1 / 479001600.;
  sum = sum * r + 1 / 39916800.;
  sum = sum * r + 1 / 3628800.;
  sum = sum * r + 1 / 362880.;
  sum = sum * r + 1 / 40320.;
  sum = sum * r + 1 / 5040.;
  sum = sum * r + 1 / 720.;
  sum = sum * r + 1 / 120.;
  sum = sum * r + 1 / 24.;
  sum = sum * r + 1 / 6.;
  sum = sum * r + 1 / 2.;
  sum = sum * r + 1;
  sum = sum * r + 1;
  const auto bits = std::bit_cast<std::uint64_t>(shifted) + 1023;
  return sum * std::bit_cast<double>(bits << 52);
}

struct SineCosine {
  double sine, cosine;
};

/// Returns sine and cosine of x, |x| <= 1e9, with an error of 2e-16 in addition to that caused by
/// the rounding of x.
inline SineCosine wide_sine_cosine(double x) {
  constexpr double shift = 0x1.8p52;
  const double shifted = x * 0x1.45f306dc9c883p-1 + shift, n = shifted - shift;
  // pi/2 is subtracted n times as a sum of three parts; n times the first or second part is exact
  // up to n = 2^20
  const double r = ((x - n * 0x1.921fb544p0) - n * 0x1.0b4611a6p-34) - n * 0x1.3198a2e037073p-69;
  const double z = r * r;
  // Taylor series, with a relative truncation error below 1e-17 for |r| <= pi/4
  const double sine_tail =
      -1 / 6. +
      z * (1 / 120. +
           z * (-1 / 5040. +
                z * (1 / 362880. +
                     z * (-1 / 39916800. + z * (1 / 6227020800. + z * (-1 / 1307674368000.))))));
  const double cosine_tail =
      1 / 24. +
      z * (-1 / 720. +
           z * (1 / 40320. +
                z * (-1 / 3628800. +
                     z * (1 / 479001600. + z * (-1 / 87178291200. + z * (1 / 20922789888000.))))));
  const double sine = r + r * z * sine_tail, cosine = (1 - z / 2) + z * z * cosine_tail;
  const auto quarter = std::bit_cast<std::uint64_t>(shifted);
  const bool is_odd = quarter & 1;
  const std::uint64_t sine_sign = (quarter & 2) << 62, cosine_sign = ((quarter + 1) & 2) << 62;
  const double s = is_odd ? cosine : sine, c = is_odd ? sine : cosine;
  return {std::bit_cast<double>(std::bit_cast<std::uint64_t>(s) ^ sine_sign),
          std::bit_cast<double>(std::bit_cast<std::uint64_t>(c) ^ cosine_sign)};
}

}  // namespace flatspeckle
