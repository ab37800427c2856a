#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include "flatland/media/domain.h"
#include "grin/media/geometry/vec3.h"
#include "mc/paths/bent/bent_chords.h"
#include "mc/paths/bent/graded_medium.h"

namespace flatspeckle::mc {

/// A wave tabulated over a box: its eikonal by bicubic Hermite interpolation of values and
/// directions, its amplitude by cubic convolution.
class WaveTable : public Wavefront {
 public:
  /// What a place of the table holds. at(x, guess): the arrival there, and n; guess is that of a
  /// place beside it. Throws InputError where a place has none.
  struct Node {
    Arrival arrival;
    double index;
  };
  using At = std::function<std::optional<Node>(Vec2 x, const Node* guess)>;
  /// spreads: from a point, so that the amplitude falls about as path^(-1/2).
  WaveTable(const Domain& box, double spacing, bool spreads, const At& at,
            const std::string& whose);

  std::optional<Arrival> at(Vec2 x) const override;

 private:
  struct Entry {
    double path, by_x, by_z, by_both, log_amplitude, inside_per_chord, launch;
  };
  const Entry& entry(std::size_t i, std::size_t j) const { return entries_[j * columns_ + i]; }
  void find_mixed_derivatives();

  Domain box_;
  bool spreads_;
  Vec2 origin_;
  double dx_, dz_;
  std::size_t columns_, rows_;  ///< one more than the box on each side
  std::vector<Entry> entries_;
};

/// n^2, and n grad n, which bends rays, of a field in the plane.
struct Bend {
  double square;
  Vec2 force;
};
/// The same and the force's derivatives.
struct BentBend : Bend {
  double xx, xz, zz;
};

/// A ray in the parameter sigma (conventions, C30): x' = v, v' = n grad n, |v| = n.
struct BentRay {
  Vec2 x, v;
};

/// A ray, its optical path, and how it moves as its direction turns where it begins.
struct RayTube : BentRay {
  Vec2 y, w;  ///< derivatives of x and v by that angle
  double path = 0;

  static RayTube from(Vec2 x, Vec2 v) { return {{x, v}, {}, {v.z, -v.x}, 0}; }
  /// J (C32); its sign changes at caustics.
  double spread() const { return y.x * v.z - y.z * v.x; }
};

/// Nystrom's method of fourth order.
template <typename BendAt>
BentRay stepped(const BentRay& ray, double h, const BendAt& bend) {
  const auto [x, v] = ray;
  const Vec2 a = bend(x).force, b = bend(x + h / 2 * v + h * h / 8 * a).force,
             c = bend(x + h * v + h * h / 2 * b).force;
  return {x + h * v + h * h / 6 * (a + 2 * b), v + h / 6 * (a + 4 * b + c)};
}

/// The same of a tube: the derivative of the step itself, and Simpson's rule of the path.
template <typename BentBendAt>
RayTube stepped(const RayTube& tube, double h, const BentBendAt& bend) {
  const auto turned = [](const BentBend& at, Vec2 y) {
    return Vec2{at.xx * y.x + at.xz * y.z, at.xz * y.x + at.zz * y.z};
  };
  const Vec2 x = tube.x, v = tube.v, y = tube.y, w = tube.w;
  const BentBend first = bend(x);
  const Vec2 a = first.force, ya = turned(first, y);
  const BentBend second = bend(x + h / 2 * v + h * h / 8 * a);
  const Vec2 b = second.force, yb = turned(second, y + h / 2 * w + h * h / 8 * ya);
  const BentBend third = bend(x + h * v + h * h / 2 * b);
  const Vec2 c = third.force, yc = turned(third, y + h * w + h * h / 2 * yb);
  RayTube next;
  next.x = x + h * v + h * h / 6 * (a + 2 * b);
  next.v = v + h / 6 * (a + 4 * b + c);
  next.y = y + h * w + h * h / 6 * (ya + 2 * yb);
  next.w = w + h / 6 * (ya + 4 * yb + yc);
  next.path = tube.path + h / 6 * (first.square + 4 * second.square + third.square);
  return next;
}

/// Any index field of grin in the plane y = 0, by steps along rays. Waves of ends are tables over
/// the box; a point in it, or close by, finds the ray to each place anew.
template <class Field>
class SteppedMedium : public GradedMedium {
 public:
  /// scale: over which the field varies.
  SteppedMedium(const Scene& scene, Field field, double scale);

  double square(Vec2 x) const override { return bend(x).square; }
  double inside(Vec2 x, Vec2 w) const override;
  std::optional<RayPlace> flown(Vec2 x, Vec2 w, double sigma) const override;

  /// The ray from a source to a place; guess: of its launch.
  std::optional<WaveTable::Node> arrival(Vec2 source, Vec2 x, std::optional<double> guess) const;

 private:
  std::shared_ptr<const Wavefront> wave_from_point(Vec2 source) const override;
  std::shared_ptr<const Wavefront> wave_from_afar(double angle) const override;
  Bend bend(Vec2 x) const;
  BentBend bent_bend(Vec2 x) const;
  BentRay begun(Vec2 x, Vec2 w) const { return {x, std::sqrt(std::max(square(x), 0.0)) * w}; }
  bool in_window(Vec2 x) const;
  /// sigma of a step that is in the domain, as a parabola.
  BentChords chords(const BentRay& from, const BentRay& to, double h) const;

  struct End {
    RayTube tube;
    double inside;
  };
  /// Along a ray to where `left`, which is positive before, is 0; none beyond a caustic, if that
  /// counts, or out of the window.
  template <typename Left>
  std::optional<End> followed(Vec2 x, Vec2 w, bool to_caustic, const Left& left) const;
  std::optional<WaveTable::Node> plane_arrival(double angle, Vec2 x,
                                               const WaveTable::Node* guess) const;

  Domain domain_;
  Field field_;
  double step_, spacing_;
  Vec2 low_, high_;  ///< of the window
};

}  // namespace flatspeckle::mc
