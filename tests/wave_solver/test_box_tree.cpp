#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include "core/numbers/random.h"
#include "wave_solver/skeletons/interpolative.h"

namespace flatspeckle::wave::test_box_tree {

namespace {

std::vector<SortedDisk> disks_in(double width, double depth, std::size_t count) {
  RandomStream random(3, 1, count);
  std::vector<SortedDisk> disks;
  for (std::size_t i = 0; i < count; ++i)
    disks.push_back({{width * random.uniform(), depth * random.uniform()},
                     0.3 * random.uniform(),
                     1 + static_cast<std::size_t>(5 * random.uniform())});
  return disks;
}

bool encloses(const Rectangle& outer, const Rectangle& inner) {
  return outer.low.x <= inner.low.x && outer.low.z <= inner.low.z && outer.high.x >= inner.high.x &&
         outer.high.z >= inner.high.z;
}

}  // namespace

TEST_CASE("box tree: leaves contain every disk once, and no more unknowns than allowed") {
  const auto disks = disks_in(30, 20, 1000);
  const BoxTree tree(disks, 50);
  std::vector<int> seen(disks.size());
  for (const auto& box : tree.boxes()) {
    if (!box.is_leaf()) continue;
    std::size_t unknowns = 0;
    for (std::size_t place = box.first; place < box.last; ++place) {
      ++seen[tree.order()[place]];
      unknowns += disks[tree.order()[place]].unknowns;
    }
    CHECK(unknowns <= 50);
  }
  CHECK(std::all_of(seen.begin(), seen.end(), [](int times) { return times == 1; }));
}

TEST_CASE("box tree: a hull encloses the rims of its disks and the hulls of its halves") {
  const auto disks = disks_in(30, 20, 500);
  const BoxTree tree(disks, 20);
  for (const auto& box : tree.boxes()) {
    for (std::size_t place = box.first; place < box.last; ++place) {
      const auto& [centre, radius, unknowns] = disks[tree.order()[place]];
      const Vec reach{radius, radius};
      CHECK(encloses(box.hull, {centre - reach, centre + reach}));
    }
    if (box.is_leaf()) continue;
    const auto &low = tree.boxes()[box.child], &high = tree.boxes()[box.child + 1];
    CHECK(encloses(box.hull, low.hull.united(high.hull)));
    CHECK(low.first == box.first);
    CHECK(low.last == high.first);
    CHECK(high.last == box.last);
    CHECK(low.level == box.level + 1);
  }
  for (std::size_t level = 0; level < tree.levels(); ++level)
    for (std::size_t box = tree.level_begin(level); box < tree.level_end(level); ++box)
      CHECK(tree.boxes()[box].level == level);
}

TEST_CASE("box tree: a strip is halved across its length until boxes are about square") {
  const BoxTree tree(disks_in(1, 64, 4000), 100);
  CHECK(tree.boxes()[0].hull.depth() > 60);
  for (const auto& box : tree.boxes())
    if (box.is_leaf()) CHECK(box.hull.depth() < 3);
}

TEST_CASE("box tree: a distant tiny cluster adds at most one level") {
  auto disks = disks_in(10, 10, 64);
  for (SortedDisk& disk : disks) disk.centre = 1e-9 * disk.centre;
  disks.push_back({{1000, 1000}});
  CHECK(BoxTree(disks, 16).levels() <= 1 + BoxTree(std::span(disks).first(64), 16).levels());
}

TEST_CASE("box tree: empty input, coincident and adjacent centres") {
  CHECK(BoxTree({}, 10).boxes().empty());
  CHECK(BoxTree({}, 10).levels() == 0);
  const std::vector<SortedDisk> alike(20, SortedDisk{{1, 2}});
  CHECK(BoxTree(alike, 4).boxes().size() == 1);
  const std::vector<SortedDisk> neighbours{{{1, 0}}, {{std::nextafter(1, 2), 0}}};
  CHECK(BoxTree(neighbours, 1).boxes().size() <= 3);
}

TEST_CASE("rectangles: distances are measured from rim to rim") {
  const Rectangle unit{{0, 0}, {1, 1}};
  CHECK(unit.distance({{4, 5}, {6, 6}}) == doctest::Approx(5));
  CHECK(unit.distance({{0.2, 3}, {0.3, 4}}) == doctest::Approx(2));
  CHECK(unit.distance({{0.5, 0.5}, {2, 2}}) == 0);
  CHECK(unit.distance(Vec{-3, 0.5}) == doctest::Approx(3));
}

}  // namespace flatspeckle::wave::test_box_tree
