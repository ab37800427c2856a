#include <cmath>
#include <filesystem>
#include <fstream>
#include <unistd.h>

#include <doctest/doctest.h>

#include "core/error.h"
#include "flatland/placement/placement.h"

namespace flatspeckle::test_placement {

namespace {

const Domain box{Domain::Kind::box, 20, 10};

Placement draw(const Scatterer& scatterer, const PlacementRule& rule, std::uint64_t number) {
  RandomStream random(5, 1, number);
  return draw_placement(box, scatterer, rule, random);
}

/// A temporary file with this text.
struct CsvFile {
  std::filesystem::path path;
  explicit CsvFile(const std::string& text)
      : path(std::filesystem::temp_directory_path() /
             ("placement" + std::to_string(getpid()) + ".csv")) {
    std::ofstream(path) << text;
  }
  ~CsvFile() { std::filesystem::remove(path); }
  Placement read(const Scatterer& scatterer) const {
    return read_placement(path.string(), scatterer);
  }
};

Scatterer disk(double radius) {
  Scatterer scatterer;
  scatterer.kind = Scatterer::Kind::tm;
  scatterer.radius = radius;
  return scatterer;
}

}  // namespace

TEST_CASE("Poisson placement: Poisson or fixed number of scatterers, uniform positions") {
  PlacementRule rule;
  rule.mean_count = 31;
  double sum = 0, sum2 = 0, x2 = 0, z = 0;
  constexpr int realizations = 4000;
  for (int r = 0; r < realizations; ++r) {
    const auto placement = draw({}, rule, static_cast<std::uint64_t>(r));
    const auto n = static_cast<double>(placement.size());
    sum += n, sum2 += n * n;
    for (const auto& placed : placement) {
      REQUIRE(box.contains(placed.position));
      x2 += placed.position.x * placed.position.x, z += placed.position.z;
    }
  }
  const double mean = sum / realizations, variance = sum2 / realizations - mean * mean;
  CHECK(std::abs(mean - 31) < 4 * std::sqrt(31.0 / realizations));
  CHECK(std::abs(variance - 31) < 4 * 31 * std::sqrt(2.0 / realizations));
  CHECK(std::abs(x2 / sum - 100.0 / 3) < 4 * 30 / std::sqrt(sum));
  CHECK(std::abs(z / sum - 5) < 4 * 2.9 / std::sqrt(sum));
  rule.count = 17;
  CHECK(draw({}, rule, 0).size() == 17);
}

TEST_CASE("hard-disk placement: gap, mean depth and rounded number of disks") {
  PlacementRule rule{PlacementRule::Kind::hard_disk, 66.6, std::nullopt, 0.2};
  double z = 0, n = 0;
  for (std::uint64_t r = 0; r < 300; ++r) {
    const auto placement = draw(disk(0.3), rule, r);
    CHECK(placement.size() == 67);
    for (std::size_t i = 0; i < placement.size(); ++i) {
      z += placement[i].position.z, n += 1;
      for (std::size_t j = 0; j < i; ++j)
        REQUIRE(length(placement[i].position - placement[j].position) >= 0.8);
    }
  }
  CHECK(std::abs(z / n - 5) < 4 * 2.9 / std::sqrt(n));
}

TEST_CASE("overlap check: agrees with a test of every pair") {
  RandomStream random(9, 1, 0);
  int clashes = 0;
  for (int r = 0; r < 300; ++r) {
    Placement placement;
    bool overlap = false;
    for (int i = 0; i < 12; ++i) {
      placement.push_back({{10 * random.uniform() - 5, 10 * random.uniform() - 5},
                           disk(0.1 + 0.5 * random.uniform())});
      for (int j = 0; j < i; ++j)
        overlap |=
            length(placement.back().position - placement[static_cast<std::size_t>(j)].position) <=
            placement.back().scatterer.radius +
                placement[static_cast<std::size_t>(j)].scatterer.radius;
    }
    clashes += overlap;
    if (overlap)
      CHECK_THROWS_AS(check_no_overlap(placement), InputError);
    else
      CHECK_NOTHROW(check_no_overlap(placement));
  }
  CHECK(clashes > 30);
  CHECK(clashes < 270);
}

TEST_CASE("placement file: columns are read by name") {
  const auto placement =
      CsvFile("z,x,radius,index_re,index_im\n1,2,0.5,1.4,0.1\n4,-3,0.25,1.5,0\n").read(disk(0));
  CHECK(placement.size() == 2);
  CHECK(placement[0].position.x == 2);
  CHECK(placement[0].position.z == 1);
  CHECK(placement[0].scatterer.index == Complex(1.4, 0.1));
  CHECK(placement[1].scatterer.radius == 0.25);
}

TEST_CASE("placement file: invalid columns, radii and overlaps are rejected") {
  CHECK_THROWS_AS(CsvFile("x,y\n1,2\n").read(disk(1)), InputError);
  CHECK_THROWS_AS(CsvFile("x,z\n1,2\n").read(disk(0)), InputError);
  CHECK_THROWS_AS(CsvFile("x,z,radius\n1,2,0\n").read(disk(1)), InputError);
  CHECK_THROWS_AS(CsvFile("x,z,radius\n0,0,1\n0,1.5,1\n").read(disk(1)), InputError);
  CHECK_THROWS_AS(CsvFile("x,z,radius\n0,0,1\n0,2,1\n").read(disk(1)), InputError);
  CHECK_THROWS_AS(CsvFile("x,z,radius,index_re\n0,0,1,0\n").read(disk(1)), InputError);
  CHECK_THROWS_AS(CsvFile("x,z\n1,2\n1,2\n").read({}), InputError);
  CHECK_NOTHROW(CsvFile("x,z\n1,2\n1,2.001\n").read({}));
}

TEST_CASE("placement in space: points are uniform in the box and spheres keep their gap") {
  const Domain cuboid{Domain::Kind::box, 6, 4, 8};
  RandomStream random(7, 1, 0);
  const auto points = draw_placement(cuboid, {}, {.mean_count = 40000, .count = 40000}, random);
  double y = 0, y2 = 0;
  for (const auto& placed : points) {
    REQUIRE(cuboid.contains(placed.position));
    y += placed.position.y;
    y2 += placed.position.y * placed.position.y;
  }
  const double count = static_cast<double>(points.size()), sigma = 8 / std::sqrt(12.0);
  CHECK(std::abs(y / count) < 4 * sigma / std::sqrt(count));
  CHECK(std::abs(y2 / count / (sigma * sigma) - 1) < 4 * std::sqrt(0.8 / count));
  const Scatterer sphere{.kind = Scatterer::Kind::soft, .radius = 0.3};
  const PlacementRule rule{PlacementRule::Kind::hard_disk, 400, 400, 0.02};  // packing 0.24
  const auto spheres = draw_placement(cuboid, sphere, rule, random);
  CHECK(spheres.size() == 400);
  check_no_overlap(spheres);
  double least = 1;
  for (std::size_t i = 0; i < spheres.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      least = std::min(least, length(spheres[i].position - spheres[j].position) - 0.6);
  CHECK(least >= 0.02);
  CHECK(std::abs(smallest_gap(spheres, 0.5) - least) < 1e-15);
  const PlacementRule dense{PlacementRule::Kind::hard_disk, 600, 600, 0.02};
  CHECK_THROWS_AS(draw_placement(cuboid, sphere, dense, random), InputError);
  PlacementRule fluid{PlacementRule::Kind::equilibrium, 600, 600, 0.02};  // packing 0.39
  check_no_overlap(draw_placement(cuboid, sphere, fluid, random));
  fluid.mean_count = 800;
  CHECK_THROWS_AS(draw_placement(cuboid, sphere, fluid, random), InputError);
}

TEST_CASE("placement in space: a table has the column y") {
  const CsvFile file("x,z,y,radius\n1,2,3,0.5\n1,2,4.1,0.5\n");
  const auto placement = read_placement(file.path.string(), disk(1), true);
  CHECK(placement[1].position == Vec{1, 2, 4.1});
  CHECK_THROWS_AS(file.read(disk(1)), InputError);
}

}  // namespace flatspeckle::test_placement
