#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/keys/written_number.h"
#include "flatland/scene/scene.h"

namespace flatspeckle::test_scene {

namespace {

SceneSpec box_points() {
  SceneSpec spec;
  spec.width = 20;
  spec.depth = 10;
  spec.count = 31;
  return spec;
}

SceneSpec box_disks() {
  SceneSpec spec = box_points();
  spec.scatterer = "tm";
  spec.radius = 0.5;
  return spec;
}

template <typename Change>
void refused(SceneSpec spec, Change change) {
  change(spec);
  CHECK_THROWS_AS(make_scene(spec), InputError);
}

constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

}  // namespace

TEST_CASE("medium: resonant points") {
  const Scene scene = make_scene(box_points());
  const double k = 2 * std::numbers::pi;
  CHECK(scene.medium.cross_sections.scattering == doctest::Approx(4 / k));
  CHECK(scene.medium.mu_t == doctest::Approx(31.0 / 200 * 4 / k));
  CHECK(scene.medium.albedo == doctest::Approx(1));
  CHECK(scene.medium.g == doctest::Approx(0));
}

TEST_CASE("medium: all keys of the density give the same medium") {
  const Scene by_count = make_scene(box_points());
  SceneSpec spec = box_points();
  spec.count.reset();
  spec.density = 31.0 / 200;
  CHECK(make_scene(spec).medium.mu_t == doctest::Approx(by_count.medium.mu_t));
  spec.density.reset();
  spec.mean_free_path = 1 / by_count.medium.mu_t;
  CHECK(make_scene(spec).medium.density == doctest::Approx(31.0 / 200));
  spec.mean_free_path.reset();
  spec.optical_depth = 10 * by_count.medium.mu_t;
  CHECK(make_scene(spec).medium.density == doctest::Approx(31.0 / 200));
}

TEST_CASE("medium: albedo 1 without absorption, the given albedo of absorbing points") {
  SceneSpec spec = box_points();
  spec.albedo = 0.8;
  CHECK(make_scene(spec).medium.albedo == doctest::Approx(0.8));
  for (const char* kind : {"tm", "te", "soft", "hard"}) {
    SceneSpec disks = box_disks();
    disks.scatterer = kind;
    CHECK(make_scene(disks).medium.albedo == doctest::Approx(1).epsilon(1e-12));
  }
}

TEST_CASE("scene: zero scatterers are allowed") {
  SceneSpec spec = box_points();
  spec.count = 0;
  CHECK(make_scene(spec).medium.mu_t == 0);
}

TEST_CASE("scene: invalid keys and combinations are rejected") {
  const auto points = box_points();
  refused(points, [](auto& s) { s.width = -3; });
  refused(points, [](auto& s) { s.width.reset(); });
  refused(points, [](auto& s) { s.depth = nan_value; });
  refused(points, [](auto& s) { s.wavelength = 0; });
  refused(points, [](auto& s) { s.density = 1; });
  refused(points, [](auto& s) { s.count.reset(); });
  refused(points, [](auto& s) { s.count = -1; });
  refused(points, [](auto& s) { s.domain = "sphere"; });
  refused(points, [](auto& s) { s.domain = "slab"; });
  refused(points, [](auto& s) { s.radius = 1; });
  refused(points, [](auto& s) { s.albedo = 0; });
  refused(points, [](auto& s) { s.albedo = 0.5, s.phase_shift = 1; });
  refused(points, [](auto& s) { s.placement = "hard_disk"; });
  refused(points, [](auto& s) { s.light_angles = {}; });
  refused(points, [](auto& s) { s.view_angles = {nan_value}; });
  refused(points, [](auto& s) { s.tilts = {0.1}; });
  refused(points, [](auto& s) { s.covariance = "memory_effect"; });
  refused(points, [](auto& s) { s.covariance = "pairs", s.pairs = {0, 1, 2}; });
  const auto disks = box_disks();
  refused(disks, [](auto& s) { s.radius.reset(); });
  refused(disks, [](auto& s) { s.index = "0"; });
  refused(disks, [](auto& s) { s.index = "1.5-0.1i"; });
  refused(disks, [](auto& s) { s.count = 200; });
  refused(disks, [](auto& s) { s.min_gap = 2; });
  refused(disks, [](auto& s) { s.g = 0.5; });
  refused(disks, [](auto& s) { s.placement = "poisson"; });
}

TEST_CASE("scene: pairs without matched transverse momentum are rejected on a slab") {
  SceneSpec spec;
  spec.domain = "slab";
  spec.scatterer = "hg";
  spec.depth = 10;
  spec.optical_depth = 1;
  spec.covariance = "pairs";
  spec.pairs = {0, 0.1, 0.2, std::asin(std::sin(0.1) + std::sin(0.2))};
  CHECK_NOTHROW(make_scene(spec));
  spec.pairs.back() += 0.01;
  CHECK_THROWS_AS(make_scene(spec), InputError);
  spec.pairs = {3, 0.1, 3, 0.1};
  CHECK_THROWS_AS(make_scene(spec), InputError);
}

TEST_CASE("scene: placement rules of disks, with a gap by default") {
  SceneSpec spec = box_disks();
  CHECK(make_scene(spec).placement.kind == PlacementRule::Kind::hard_disk);
  CHECK(make_scene(spec).placement.min_gap == default_gap * 0.5);
  spec.min_gap = 0;
  CHECK(make_scene(spec).placement.min_gap == 0);
  spec.placement = "equilibrium";
  spec.count = 175;  // packing 0.687
  CHECK(make_scene(spec).placement.kind == PlacementRule::Kind::equilibrium);
  refused(spec, [](auto& s) { s.placement = "hard_disk"; });
  refused(spec, [](auto& s) { s.min_gap = 0.01; });
  refused(spec, [](auto& s) { s.count = 177; });
  spec.count = 5;
  refused(spec, [](auto& s) { s.depth = 2.9; });
  refused(box_points(), [](auto& s) { s.placement = "equilibrium"; });
  CHECK(make_scene(box_points()).placement.min_gap == 0);
}

TEST_CASE("parse_complex: accepted and rejected texts of scenes") {
  CHECK(parse_complex("index", "1.5") == Complex(1.5, 0));
  CHECK(parse_complex("index", "1.5+0.1i") == Complex(1.5, 0.1));
  CHECK(parse_complex("index", " 0.1 + 5i ") == Complex(0.1, 5));
  CHECK(parse_complex("index", "1e-3-2.5e+1j") == Complex(1e-3, -25));
  CHECK(parse_complex("index", "1+i") == Complex(1, 1));
  for (const char* bad : {"", "i", "1+", "1.5 0.1i", "abc", "nan", "1+0.1"})
    CHECK_THROWS_AS(parse_complex("index", bad), InputError);
}

TEST_CASE("scene: a structure factor requires disks of given density") {
  const auto refusal = [](SceneSpec spec, auto change) {
    change(spec);
    try {
      make_scene(spec);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  const auto check_contains = [](const std::string& text, const char* word) {
    INFO(text);
    CHECK(text.find(word) != std::string::npos);
  };
  SceneSpec disks = box_disks(), points = box_points();
  disks.structure = points.structure = "hard_disks";
  const Scene scene = make_scene(disks);
  CHECK_FALSE(scene.medium.structure.independent());
  check_contains(scene.medium.structure.origin(), "of hard disks, packing fraction 0.12");
  check_contains(refusal(points, [](auto&) {}),
                 "structure = hard_disks: is a key of cylinders and spheres only");
  check_contains(refusal(points,
                         [](auto& s) {
                           s.scatterer = "hg";
                           s.count.reset();
                           s.optical_depth = 1;
                         }),
                 "structure = hard_disks: is a key of");
  const auto by = [](auto SceneSpec::*key) {
    return [key](auto& s) {
      s.count.reset();
      s.*key = 1.5;
    };
  };
  check_contains(refusal(disks, by(&SceneSpec::mean_free_path)),
                 "mean_free_path = 1.5: cannot be combined with structure");
  check_contains(refusal(disks, by(&SceneSpec::optical_depth)),
                 "optical_depth = 1.5: cannot be combined with structure");
  check_contains(refusal(disks, [](auto& s) { s.structure = "no_such_file.h5"; }),
                 "no_such_file.h5");
  // Gaps are included: the same disks with wider gaps are a denser fluid.
  disks.min_gap = 0.2;
  check_contains(make_scene(disks).medium.structure.origin(), "packing fraction 0.175");
}

}  // namespace flatspeckle::test_scene
