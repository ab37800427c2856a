#include <string>

#include <doctest/doctest.h>

#include "inside_disks.h"
#include "tests/statistics.h"

namespace flatspeckle::wave::test_inside_disks {

using flatspeckle::tests::is_night;

TEST_CASE(
    "fields on both sides of rims: small clusters agree with an oracle within the tolerance") {
  const std::vector<double> tolerances{1e-3, 1e-6, 1e-9};
  const auto worst = worst_errors(107, is_night ? 4 : 2, {13, 1300}, tolerances);
  for (std::size_t i = 0; i < worst.size(); ++i) {
    CAPTURE(tolerances[i]);
    CHECK(worst[i].inside < 1);
    CHECK(worst[i].outside < 1);
  }
}

TEST_CASE("fields in narrow gaps: both rims agree with an oracle within the tolerance") {
  for (const std::string kind : {"D", "N", "TM15", "TE15"}) {
    CAPTURE(kind);
    // outside nightly runs two kinds each
    if (is_night || kind.size() == 1) check_gap(kind, 1, 0.1, {1e-3, 1e-6, 1e-9});
    if (is_night || kind.size() > 1) check_gap(kind, 0.2, 0.03, {1e-3, 1e-6, 1e-9});
  }
}

TEST_CASE(
    "nightly: fields on both sides of rims: 60 clusters of 2 to 13 disks agree with an oracle") {
  const std::vector<double> tolerances{1e-3, 1e-6, 1e-9, 1e-12};
  const auto worst = worst_errors(100, 60, {13, 5000}, tolerances);
  for (std::size_t i = 0; i < worst.size(); ++i) {
    CAPTURE(tolerances[i]);
    CHECK(worst[i].inside < 1);
    CHECK(worst[i].outside < 1);
  }
}

TEST_CASE(
    "nightly: fields in the narrowest gaps: both rims agree with an oracle within the tolerance") {
  for (const std::string kind : {"D", "N", "TM15", "TE15"})
    for (const double ratio : {1.0, 0.2})
      for (const double gap : {0.1, 0.01, 1e-3}) {
        if (kind == "N" && gap < 0.01) continue;  // a thousand unknowns each
        CAPTURE(kind);
        check_gap(kind, ratio, gap, {1e-3, 1e-6, 1e-9, 1e-12});
      }
}

TEST_CASE("nightly: field map of hundred_disks.toml agrees with an oracle within the tolerance") {
  const Scatterer disk{.kind = Scatterer::Kind::tm, .radius = 0.4, .index = 1.5};
  const PlacementRule rule{
      .kind = PlacementRule::Kind::hard_disk, .mean_count = 100, .count = 100, .min_gap = 0.05};
  RandomStream random(1, static_cast<std::uint64_t>(Stream::placement), 0);
  const Placement placement = draw_placement({Domain::Kind::box, 18, 14}, disk, rule, random);
  constexpr double tolerance = 1e-8;
  CHECK(worst_on_map(placement, 0, {{-10, -4}, {10, 18}, 600, 660}, tolerance, 37) < tolerance);
}

}  // namespace flatspeckle::wave::test_inside_disks
