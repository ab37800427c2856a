#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include "core/error.h"
#include "flatland/media/structure_factor.h"
#include "flatland/placement/equilibrium_disks.h"
#include "flatland/placement/placement.h"
#include "periodic_disks.h"
#include "tests/statistics.h"

namespace flatspeckle::tests::test_equilibrium_disks {

namespace {

std::vector<Vec> draw(const Domain& box, const std::vector<double>& radii, std::uint64_t number,
                      double min_gap = 0,
                      PlacementRule::Kind kind = PlacementRule::Kind::equilibrium) {
  RandomStream random(21, 1, number);
  return draw_disks(box, radii, kind, min_gap, random);
}

MeasuredStructureFactor measure(const Domain& box, std::size_t disks, int realizations,
                                PlacementRule::Kind kind) {
  MeasuredStructureFactor measured(box, 14, 0.5);
  for (int r = 0; r < realizations; ++r)
    measured.add(
        draw(box, std::vector<double>(disks, 0.5), static_cast<std::uint64_t>(r), 0, kind));
  return measured;
}

/// Largest difference of two measurements, in standard errors, and the mean square difference.
struct Difference {
  double largest = 0, mean_square = 0;
  Difference(const MeasuredStructureFactor& a, const MeasuredStructureFactor& b) {
    const auto a_values = a.values(), b_values = b.values(), a_errors = a.errors(),
               b_errors = b.errors();
    for (std::size_t i = 0; i < a_values.size(); ++i) {
      const double z = (a_values[i] - b_values[i]) / std::hypot(a_errors[i], b_errors[i]);
      largest = std::max(largest, std::abs(z));
      mean_square += z * z / static_cast<double>(a_values.size());
    }
  }
};

}  // namespace

TEST_CASE(
    "equilibrium disks: keep their gap, also across periodic edges, up to the highest packing") {
  for (const double packing : {0.05, 0.4, 0.69}) {
    const Domain box = unit_disk_box(60, packing);
    const std::vector<double> radii(60, 0.48);
    const auto centres = draw(box, radii, 1, 0.04);
    REQUIRE(centres.size() == 60);
    for (std::size_t i = 0; i < centres.size(); ++i) {
      CHECK(box.contains(centres[i]));
      for (std::size_t j = 0; j < i; ++j)
        REQUIRE(periodic_distance(box, centres[i], centres[j]) >= 1);
    }
  }
}

TEST_CASE("mixed radii: no overlap for either rule, and radii correspond to their centres") {
  const Domain box{Domain::Kind::box, 12, 8};
  std::vector<double> radii(40, 0.4);
  for (std::size_t i = 0; i < radii.size(); i += 4) radii[i] = 0.8;
  for (const auto kind : {PlacementRule::Kind::equilibrium, PlacementRule::Kind::hard_disk}) {
    const auto centres = draw(box, radii, 3, 0.01, kind);
    for (std::size_t i = 0; i < centres.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        REQUIRE(length(centres[i] - centres[j]) >= radii[i] + radii[j] + 0.01);
  }
}

TEST_CASE("mixed radii: a few large disks are placed among many small ones") {
  const Domain box{Domain::Kind::box, 6, 6};
  std::vector<double> radii(800, 0.065);
  radii.resize(812, 0.4);
  for (const auto kind : {PlacementRule::Kind::equilibrium, PlacementRule::Kind::hard_disk})
    CHECK(draw(box, radii, 3, 0, kind).size() == radii.size());
}

TEST_CASE("equilibrium disks: determined by the random numbers") {
  const Domain box = unit_disk_box(30, 0.5);
  const std::vector<double> radii(30, 0.5);
  const auto first = draw(box, radii, 7), again = draw(box, radii, 7), other = draw(box, radii, 8);
  for (std::size_t i = 0; i < first.size(); ++i) {
    CHECK(first[i].x == again[i].x);
    CHECK(first[i].z == again[i].z);
    CHECK(first[i].x != other[i].x);
  }
}

TEST_CASE("equilibrium disks: the density is uniform, also at the edges (chi-squared)") {
  const Domain box{Domain::Kind::box, 6, 5};
  std::vector<double> counts_x(10), counts_z(10);
  // Only one disk of each realization, because the others are correlated with it.
  for (std::uint64_t r = 0; r < 2000; ++r) {
    const auto centres = draw(box, std::vector<double>(12, 0.5), r);
    const Vec at = centres[r % centres.size()];
    counts_x[static_cast<std::size_t>((at.x / box.width + 0.5) * 10)] += 1;
    counts_z[static_cast<std::size_t>(at.z / box.depth * 10)] += 1;
  }
  check_chi_square(counts_x, std::vector<double>(10, 0.1));
  check_chi_square(counts_z, std::vector<double>(10, 0.1));
}

TEST_CASE("equilibrium disks: few disks and none") {
  const Domain box{Domain::Kind::box, 5, 5};
  CHECK(draw(box, {}, 0).empty());
  CHECK(draw(box, {0.5}, 0).size() == 1);
  CHECK(draw({Domain::Kind::box, 1e4, 1e4}, {0.5, 0.1}, 0).size() == 2);
}

// The accuracy of the theory (structure_factor.h) is 1 % at 0.3 and 2.5 % at 0.5.
TEST_CASE("equilibrium disks: the structure factor agrees with theory") {
  for (const double packing : {0.3, 0.5}) {
    const double accuracy = packing < 0.4 ? 0.01 : 0.025;
    constexpr std::size_t disks = 150;
    const Domain box = unit_disk_box(disks, packing);
    const auto measured = measure(box, disks, 300, PlacementRule::Kind::equilibrium);
    const HardDiskFluid fluid(packing, 1);
    const auto theory = measured.shell_means([&](double q) { return fluid.structure_factor(q); });
    const auto values = measured.values(), errors = measured.errors();
    for (std::size_t i = 0; i < values.size(); ++i) {
      CAPTURE(packing);
      CAPTURE(i);
      CHECK(std::abs(values[i] - theory[i]) < 4 * errors[i] + accuracy * theory[i]);
    }
  }
}

TEST_CASE("random sequential addition: its structure factor differs from equilibrium") {
  constexpr std::size_t disks = 150;
  const Domain box = unit_disk_box(disks, 0.48);
  const Difference difference(measure(box, disks, 100, PlacementRule::Kind::equilibrium),
                              measure(box, disks, 100, PlacementRule::Kind::hard_disk));
  MESSAGE("largest difference " << difference.largest << " standard errors");
  CHECK(difference.largest > 8);
}

TEST_CASE("equilibrium disks: S(q) agrees with a long run from a lattice") {
  constexpr std::size_t disks = 100;
  constexpr double packing = 0.65;
  const Domain box = unit_disk_box(disks, packing);
  EventChains chains(box, std::vector<double>(disks, 0.5));
  for (std::size_t i = 0; i < disks; ++i) {
    const auto column = static_cast<double>(i % 10), row = static_cast<double>(i / 10);
    REQUIRE(chains.place(i, {(column / 10 - 0.45) * box.width, (row / 10 + 0.05) * box.depth}));
  }
  RandomStream random(31, 1, 0);
  const auto move = [&](int number) {
    for (int i = 0; i < number; ++i)
      chains.move(random.uniform() < 0.5 ? 0 : 1,
                  static_cast<std::size_t>(random.uniform() * disks), 2);
  };
  MeasuredStructureFactor long_run(box, 14, 0.5);
  move(10000);
  for (int r = 0; r < 300; ++r) {
    move(1000);  // 200 contacts per disk: several of the slowest relaxation times
    std::vector<Vec> centres;
    for (std::size_t i = 0; i < disks; ++i) centres.push_back(chains.centre(i));
    long_run.add(centres);
  }
  const Difference difference(long_run, measure(box, disks, 200, PlacementRule::Kind::equilibrium));
  MESSAGE("largest difference " << difference.largest << ", mean square "
                                << difference.mean_square);
  CHECK(difference.largest < 4);
  CHECK(difference.mean_square < 2.5);
}

TEST_CASE("disks: too dense packings and too small boxes are rejected") {
  const auto refused = [](const Domain& box, const std::vector<double>& radii, double min_gap,
                          PlacementRule::Kind kind) {
    CHECK_THROWS_AS(draw(box, radii, 0, min_gap, kind), InputError);
  };
  const std::vector<double> radii(50, 0.5);
  refused(unit_disk_box(50, 0.7), radii, 0, PlacementRule::Kind::equilibrium);
  refused(unit_disk_box(50, 0.6), radii, 0.1, PlacementRule::Kind::equilibrium);
  refused(unit_disk_box(50, 0.51), radii, 0, PlacementRule::Kind::hard_disk);
  refused({Domain::Kind::box, 2.9, 50}, radii, 0, PlacementRule::Kind::equilibrium);
  refused({Domain::Kind::box, 50, 2.9}, radii, 0, PlacementRule::Kind::equilibrium);
  CHECK_NOTHROW(draw(unit_disk_box(50, 0.69), radii, 0, default_gap * 0.5));
}

}  // namespace flatspeckle::tests::test_equilibrium_disks
