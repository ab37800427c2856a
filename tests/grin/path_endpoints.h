#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <doctest/doctest.h>

#include "grin/media/scattering/start_directions.h"
#include "grin/rays/connections/geometric_spreading.h"
#include "grin/render/endpoints/path_end.h"
#include "tests/statistics.h"

namespace flatspeckle::grin {

// Helpers for tests of light sources and sensors: index fields, straight rays, and an average with
// its standard error.

struct UniformSpace {
  double n = 1;
  double index(const PathPoint&) const { return n; }
};
/// An index that varies in all directions.
struct TiltedSpace {
  double index(const PathPoint& p) const { return 1.4 + p.x.dot(Vec3(0.1, -0.07, 0.05)); }
};

inline const Box test_box{Vec3(-1, -2, 0.5), Vec3(2, 1, 3)};
inline const Sphere test_sphere{Vec3(0.3, -0.2, 0.1), 1.7};

inline Stage empty_stage(const Surface& boundary) {
  return {.boundary = boundary, .medium = {}, .bodies = {}, .excess_around = 0};
}

/// Returns the point where a straight ray leaves the boundary; x is inside or on it.
inline Vec3 exit_point(const Surface& boundary, const Vec3& x, const Vec3& d) {
  if (const auto* sphere = std::get_if<Sphere>(&boundary)) {
    const Vec3 r = x - sphere->centre;
    const double b = r.dot(d);
    return x + (std::sqrt(b * b - r.squaredNorm() + sphere->radius * sphere->radius) - b) * d;
  }
  const auto& box = std::get<Box>(boundary);
  double reach = INFINITY;
  int face = 0;
  for (int a = 0; a < 3; ++a) {
    if (d[a] == 0) continue;
    const double t = ((d[a] > 0 ? box.high[a] : box.low[a]) - x[a]) / d[a];
    if (t < reach) reach = t, face = a;
  }
  Vec3 exit = x + reach * d;
  exit[face] = d[face] > 0 ? box.high[face] : box.low[face];
  return exit;
}

class Average {
 public:
  void add(double value) {
    ++count_;
    sum_ += value;
    squares_ += value * value;
  }
  double mean() const { return sum_ / count_; }
  double error() const {
    return std::sqrt(std::max(0.0, squares_ / count_ - mean() * mean()) / (count_ - 1));
  }
  /// Checks the mean to 4 standard errors plus the rounding error of the sum.
  void check(double expected) const {
    CAPTURE(mean());
    CAPTURE(expected);
    CAPTURE(error());
    CHECK(std::abs(mean() - expected) <= 4 * error() + count_ * 2.3e-16 * std::abs(expected));
  }

 private:
  double count_ = 0, sum_ = 0, squares_ = 0;
};

/// Compares directions from sample(random) with the density of towards(direction); both return an
/// EndDirection. A chi-square test over equal solid angles around `axis` also checks that the
/// density integrates to 1.
template <class Sample, class Towards>
void check_directions(const Sample& sample, const Towards& towards, const Vec3& axis,
                      std::uint64_t seed) {
  constexpr int rings = 20, sectors = 12, parts = 32, samples = 100000;
  using std::numbers::pi;
  const Vec3 across = frame_across(axis).col(0), other = frame_across(axis).col(1);
  std::vector<double> counts(rings * sectors), probabilities(rings * sectors);
  RandomStream random(seed, 79, 0);
  for (int i = 0; i < samples; ++i) {
    const Vec3 d = sample(random).direction;
    const double azimuth = std::atan2(d.dot(other), d.dot(across)) / (2 * pi);
    const int ring = std::min(static_cast<int>((d.dot(axis) + 1) / 2 * rings), rings - 1);
    const int sector = std::min(static_cast<int>((azimuth + 0.5) * sectors), sectors - 1);
    ++counts[ring * sectors + sector];
  }
  for (int i = 0; i < rings * parts; ++i)
    for (int j = 0; j < sectors * parts; ++j) {
      const double cosine = 2 * (i + 0.5) / (rings * parts) - 1;
      const double azimuth = 2 * pi * ((j + 0.5) / (sectors * parts) - 0.5);
      probabilities[i / parts * sectors + j / parts] +=
          towards(direction_about(axis, cosine, azimuth)).density * 4 * pi /
          (rings * sectors * parts * parts);
    }
  flatspeckle::tests::check_chi_square(counts, probabilities);
}

/// Checks that the values from sampling a direction equal those of towards() for the same
/// direction.
inline void check_same(const EndDirection& a, const EndDirection& b) {
  CHECK(a.density == doctest::Approx(b.density).epsilon(1e-11));
  CHECK(a.strength == doctest::Approx(b.strength).epsilon(1e-11));
  CHECK(a.pixel == b.pixel);
}

/// Samples positions and directions of an endpoint and checks that a ray that hits the endpoint
/// there, in the opposite direction, returns the same values.
template <class End, class Space>
void check_hits(const End& end, const Space& space, std::uint64_t seed) {
  RandomStream random(seed, 80, 0);
  for (int i = 0; i < 1000; ++i) {
    const EndPosition at = end.sample_position(space, random);
    const EndDirection to = end.sample_direction(at, random);
    check_same(to, end.towards(at, to.direction));
    int hits = 0;
    end.hit(space, at.point.x, -to.direction, [&](const EndHit& hit) {
      if (hit.position.light != at.light) return;
      ++hits;
      CHECK(hit.position.position_density == doctest::Approx(at.position_density).epsilon(1e-12));
      CHECK((hit.position.inward - at.inward).norm() < 1e-12);
      CHECK((hit.direction.direction - to.direction).norm() == 0);
      CHECK(hit.position.index == space.index(at.point));
      check_same(hit.direction, to);
      const double n = space.index(at.point);
      CHECK(hit.value * n * n * to.direction.dot(at.inward) ==
            doctest::Approx(to.strength).epsilon(1e-11));
    });
    CHECK(hits == (to.strength > 0 ? 1 : 0));
    end.hit(space, at.point.x, to.direction, [](const EndHit&) { CHECK(false); });  // from behind
  }
}

}  // namespace flatspeckle::grin
