#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <doctest/doctest.h>

#include "core/numbers/random.h"
#include "grating_oracle.h"
#include "wave_solver/periodic/scattering_matrix.h"

namespace flatspeckle::wave {

namespace {

constexpr double pi = std::numbers::pi;
using Kind = Scatterer::Kind;

double largest_difference(const ScatteringMatrix& found, std::size_t light,
                          const GratingField& field) {
  const std::size_t n = found.channels.size();
  double worst = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double flux = std::sqrt(found.channels[i].cosine / found.channels[light].cosine);
    const Complex* const out = &found.s[found.size() * light];
    worst = std::max({worst, std::abs(out[i] - flux * field.reflected[i]),
                      std::abs(out[i + n] - flux * field.transmitted[i])});
  }
  return worst;
}

struct Row {
  Scatterer cylinder;
  double k_width, phase;
};

// Draws cylinders in a slab, none closer than `gap` to another one or to its copies.
Placement slab(const Scatterer& cylinder, double width, double depth, int count, double gap) {
  RandomStream random(1, 0, 0);
  Placement placement;
  while (static_cast<int>(placement.size()) < count) {
    const Vec r{width * random.uniform(), depth * random.uniform()};
    const bool free = std::ranges::none_of(placement, [&](const PlacedScatterer& placed) {
      const double x = std::remainder(r.x - placed.position.x, width);
      return std::hypot(x, r.z - placed.position.z) < 2 * cylinder.radius + gap;
    });
    if (free) placement.push_back({r, cylinder});
  }
  return placement;
}

double largest_difference(const std::vector<Complex>& a, const std::vector<Complex>& b) {
  double worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, std::abs(a[i] - b[i]));
  return worst;
}

}  // namespace

TEST_CASE("periodic cell: one cylinder a period agrees with matched expansions") {
  const double k = 2 * pi;
  const std::vector<Row> rows{
      {{.kind = Kind::soft, .radius = 0.15}, 7.3, 0.4},
      {{.kind = Kind::hard, .radius = 0.2}, 9.1, -1.1},
      {{.kind = Kind::tm, .radius = 0.25, .index = 1.5}, 13.0, 0.0},
      {{.kind = Kind::te, .radius = 0.25, .index = 1.5}, 13.0, pi},
      {{.kind = Kind::tm, .radius = 0.1, .index = 1.4}, 4 * pi, 1e-7},  // beside an anomaly
      {{.kind = Kind::te, .radius = 0.1, .index = 1.4}, 4 * pi, 0},     // at two anomalies
      {{.kind = Kind::soft, .radius = 2}, 200.0, 0.3},
  };
  for (const Row& row : rows) {
    CAPTURE(row.k_width);
    CAPTURE(row.phase);
    const Period period{row.k_width / k, row.phase};
    const auto found = scattering_matrix({{{0, 0}, row.cylinder}}, k, period, {.tolerance = 1e-11});
    const std::size_t light = found.channels.size() / 2;
    const auto field = grating_oracle(row.cylinder, k, period, found.channels[light]);
    CHECK(field.misfit < 1e-9);
    CHECK(largest_difference(found, light, field) < 1e-8);
    CHECK(found.power.off < 1e-10);
    CHECK(found.reciprocity.off < 1e-10);
  }
}

// At a period of 8 wavelengths and normal incidence two channels are at grazing.
TEST_CASE("scattering matrix: lossless slabs are unitary and reciprocal, absorbing ones balance") {
  const double k = 2 * pi;
  struct Slab {
    Scatterer cylinder;
    double width, depth, phase;
    int count;
  };
  const std::vector<Slab> slabs{
      {{.kind = Kind::tm, .radius = 0.3, .index = 1.5}, 8, 4, 0, 40},
      {{.kind = Kind::te, .radius = 0.3, .index = 1.5}, 4.3, 2, pi, 9},
      {{.kind = Kind::hard, .radius = 0.2}, 3.1, 5, 0.8, 16},
      {{.kind = Kind::tm, .radius = 0.3, .index = 1.5}, 3.1, 16, 0.8, 50},  // boxes span the period
      {{.kind = Kind::point}, 20.2, 5, 0, 60},
      {{.kind = Kind::tm, .radius = 0.3, .index = {1.5, 0.02}}, 6.2, 3, 0.8, 20}};
  for (const Slab& given : slabs) {
    CAPTURE(given.width);
    const auto placement = slab(given.cylinder, given.width, given.depth, given.count, 0.05);
    const auto found = scattering_matrix(placement, k, {given.width, given.phase},
                                         {.tolerance = 1e-10, .method = Method::dense});
    CHECK(found.power.off < 1e-9);
    CHECK(found.reciprocity.off < 1e-9);
    if (given.cylinder.index.imag() > 0) CHECK(found.absorbed[0] > 0.03);
    const auto fast = scattering_matrix(placement, k, {given.width, given.phase},
                                        {.tolerance = 1e-10, .method = Method::fast});
    CHECK(largest_difference(found.s, fast.s) < 1e-9);
    CHECK(fast.power.off < 1e-9);
  }
}

// The boxes span the period: coupling to near copies is as strong as within the cell.
TEST_CASE("scattering matrix: unit cells that begin at different x give the same fast solution") {
  const double k = 2 * pi;
  const Period period{6.2, 0};
  const SolveOptions options{.tolerance = 1e-6, .method = Method::fast};
  const auto placement =
      slab({.kind = Kind::tm, .radius = 0.3, .index = 1.5}, period.width, 16, 100, 0.05);
  auto found = scattering_matrix(placement, k, period, options);
  compare_unit_cells(found, placement, k, period, options);
  CHECK(found.unit_cell.off < 1e-5);
  CHECK(found.unit_cell.off > 1e-12);  // the skeletons differ
  CHECK(found.unit_cell.holds());
  CHECK(found.unit_cell.limit > 0);
}

}  // namespace flatspeckle::wave
