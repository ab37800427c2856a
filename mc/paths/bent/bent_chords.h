#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "flatland/media/domain.h"

namespace flatspeckle::mc {

/// Parts of a parabolic ray x + v s + f s^2/2, 0 <= s <= end, that lie in a domain, in the order of
/// s.
class BentChords {
 public:
  struct Chord {
    double enter, leave;
  };

  BentChords(const Domain& domain, Vec x, Vec v, Vec f, double end) {
    if (domain.kind == Domain::Kind::box) {
      add_roots(x.x - domain.width / 2, v.x, f.x, end);
      add_roots(x.x + domain.width / 2, v.x, f.x, end);
    }
    add_roots(x.z, v.z, f.z, end);
    add_roots(x.z - domain.depth, v.z, f.z, end);
    std::sort(roots_.begin(), roots_.begin() + count_);
    roots_[count_++] = end;
    double from = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      const double to = roots_[i], middle = std::min((from + to) / 2, from + 1);
      if (to > from && domain.contains(x + middle * v + middle * middle / 2 * f)) append(from, to);
      from = to;
    }
  }

  double length() const {
    double sum = 0;
    for (const Chord& chord : *this) sum += chord.leave - chord.enter;
    return sum;
  }
  /// Returns the s up to which the ray has covered a length `inside` (in s) in the domain; a value
  /// beyond `end` if all its parts in the domain together are shorter.
  double at(double inside) const {
    for (const Chord& chord : *this) {
      if (inside <= chord.leave - chord.enter) return chord.enter + inside;
      inside -= chord.leave - chord.enter;
    }
    return 2 * roots_[count_ - 1] + 1;
  }
  const Chord* begin() const { return chords_.data(); }
  const Chord* end() const { return chords_.data() + chord_count_; }

 private:
  /// Adds the roots s of c + b s + a s^2/2 = 0 between 0 and `end`, computed without cancellation.
  void add_roots(double c, double b, double a, double end) {
    const double square = b * b - 2 * a * c;
    if (square < 0) return;
    const double q = -(b + std::copysign(std::sqrt(square), b));
    for (const double root : {q / a, 2 * c / q})
      if (root > 0 && root < end) roots_[count_++] = root;  // excludes NaN and infinity
  }
  void append(double from, double to) {
    if (chord_count_ > 0 && chords_[chord_count_ - 1].leave == from)
      chords_[chord_count_ - 1].leave = to;
    else
      chords_[chord_count_++] = {from, to};
  }

  std::array<double, 9> roots_{};
  std::array<Chord, 9> chords_{};
  std::size_t count_ = 0, chord_count_ = 0;
};

}  // namespace flatspeckle::mc
