#include <numbers>

#include <doctest/doctest.h>

#include "core/error.h"
#include "flatland/scene/scene.h"

namespace flatspeckle::test_suspension_keys {

namespace {

using std::numbers::pi;

SceneSpec cylinders() {
  SceneSpec spec;
  spec.scatterer = "tm";
  spec.domain = "slab";
  spec.depth = 100;
  spec.radius = 0.25;
  spec.volume_fraction = 0.02;
  return spec;
}

SceneSpec spheres() {
  SceneSpec spec = cylinders();
  spec.scatterer = "mie";
  spec.dimension = 3;
  return spec;
}

template <typename Change>
void refused(SceneSpec spec, const char* message, const Change& change) {
  change(spec);
  CHECK_THROWS_WITH_AS(make_scene(spec), doctest::Contains(message), InputError);
}

}  // namespace

TEST_CASE("suspension: a volume fraction sets the number of cylinders per area") {
  SceneSpec spec = cylinders();
  const BulkMedium medium = make_scene(spec).medium;
  CHECK(medium.packing_fraction == doctest::Approx(0.02).epsilon(1e-14));
  CHECK(medium.density == doctest::Approx(0.02 / (pi / 16)).epsilon(1e-14));
  spec.volume_fraction.reset();
  spec.density = medium.density;
  CHECK(make_scene(spec).medium.mu_t == medium.mu_t);
}

TEST_CASE("suspension: a mass fraction and two densities set the volume fraction") {
  for (SceneSpec spec : {cylinders(), spheres()}) {
    spec.volume_fraction.reset();
    spec.mass_fraction = 0.01;
    spec.particle_density = 1.05;
    spec.medium_density = 1;
    const double volumes[] = {0.01 / 1.05, 0.99};
    const double fraction = volumes[0] / (volumes[0] + volumes[1]);
    CHECK(make_scene(spec).medium.packing_fraction == doctest::Approx(fraction).epsilon(1e-14));
    spec.particle_density = 1050;  // kg/m^3
    spec.medium_density = 1000;
    CHECK(make_scene(spec).medium.packing_fraction == doctest::Approx(fraction).epsilon(1e-14));
  }
}

TEST_CASE("suspension: the density of spheres is a number per volume") {
  const BulkMedium medium = make_scene(spheres()).medium;
  CHECK(medium.density == doctest::Approx(0.02 / (4 * pi / 3 / 64)).epsilon(1e-14));
}

TEST_CASE("suspension: diameter and particle_index describe the same particles") {
  SceneSpec spec = cylinders();
  spec.medium_index = 1.33;
  spec.wavelength = 1.33;
  spec.index = "1.2+0.1i";
  const Scene by_ratio = make_scene(spec);
  CHECK(by_ratio.wavelength == doctest::Approx(1).epsilon(1e-15));
  spec.index.reset();
  spec.radius.reset();
  spec.diameter = 0.5;
  spec.particle_index = "1.596+0.133i";
  const Scene scene = make_scene(spec);
  CHECK(scene.scatterer.radius == by_ratio.scatterer.radius);
  CHECK(std::abs(scene.scatterer.index - by_ratio.scatterer.index) < 1e-15);
  CHECK(scene.medium.mu_t == doctest::Approx(by_ratio.medium.mu_t).epsilon(1e-12));
}

TEST_CASE("suspension: keys that contradict one another or have no meaning are rejected") {
  refused(cylinders(), "volume_fraction", [](auto& s) { s.density = 1; });
  refused(cylinders(), "diameter = 0.5: cannot be combined with radius",
          [](auto& s) { s.diameter = 0.5; });
  refused(cylinders(), "give radius or diameter", [](auto& s) { s.radius.reset(); });
  refused(spheres(), "give radius or diameter", [](auto& s) { s.radius.reset(); });
  refused(cylinders(), "particle_index = 1.59: requires medium_index",
          [](auto& s) { s.particle_index = "1.59"; });
  refused(cylinders(), "particle_index = 1.59: cannot be combined with index", [](auto& s) {
    s.medium_index = 1.33;
    s.index = "1.2";
    s.particle_index = "1.59";
  });
  refused(cylinders(), "particle_index = -1.59: must not", [](auto& s) {
    s.medium_index = 1.33;
    s.particle_index = "-1.59";
  });
  refused(cylinders(), "particle_density = 1: is a key of mass_fraction only",
          [](auto& s) { s.particle_density = 1; });
  const auto by_mass = [](auto& s) {
    s.volume_fraction.reset();
    s.mass_fraction = 0.1;
    s.particle_density = 1.05;
  };
  refused(cylinders(), "medium_density is not given", by_mass);
  refused(cylinders(), "volume_fraction = 0.02: is a key of soft, hard, tm, te and mie",
          [](auto& s) {
            s.scatterer = "point";
            s.radius.reset();
          });
  refused(cylinders(), "diameter = 1: is a key of soft", [](auto& s) {
    s.scatterer = "hg";
    s.radius.reset();
    s.volume_fraction.reset();
    s.optical_depth = s.diameter = 1;
  });
  refused(spheres(), "volume fraction = 0.75: must be at most 0.74",
          [](auto& s) { s.volume_fraction = 0.75; });
  refused(spheres(), "at most 0.49", [](auto& s) {
    s.volume_fraction = 0.5;
    s.structure = "hard_spheres";
  });
  refused(spheres(), "structure = hard_disks: must be hard_spheres",
          [](auto& s) { s.structure = "hard_disks"; });
  refused(cylinders(), "structure = hard_spheres: requires dimension = 3",
          [](auto& s) { s.structure = "hard_spheres"; });
  refused(spheres(), "optical_depth = 3: cannot be combined with structure", [](auto& s) {
    s.volume_fraction.reset();
    s.optical_depth = 3;
    s.structure = "hard_spheres";
  });
  refused(spheres(), "count = 10: an infinite slab", [](auto& s) {
    s.volume_fraction.reset();
    s.count = 10;
  });
}

}  // namespace flatspeckle::test_suspension_keys
