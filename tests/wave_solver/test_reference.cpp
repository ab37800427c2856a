// Compares fixed placements with the tables of data/reference (sources: its README).

#include <algorithm>
#include <sstream>
#include <string>

#include <doctest/doctest.h>

#include "core/keys/csv.h"
#include "reference.h"
#include "wave_solver/solutions/wave_solution.h"

namespace flatspeckle::wave::test_reference {

namespace {

struct ReferenceField {
  std::vector<double> lights;
  std::vector<View> views;
  std::vector<std::size_t> light_of_row;
  std::vector<Complex> field;
};

ReferenceField read_field(const std::string& name, bool near) {
  const Table table = read_csv(reference_path(name));
  ReferenceField reference;
  auto& lights = reference.lights;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const auto cell = [&](const char* column) { return table.column(column)[row]; };
    auto light = std::find(lights.begin(), lights.end(), cell("light_angle"));
    if (light == lights.end()) light = lights.insert(light, cell("light_angle"));
    reference.light_of_row.push_back(light - lights.begin());
    reference.views.push_back(near ? near_sensor({cell("x"), cell("z")})
                                   : far_view(cell("view_angle")));
    reference.field.emplace_back(cell("re"), cell("im"));
  }
  return reference;
}

double error_against(const std::string& name, bool near, const Placement& placement,
                     double tolerance) {
  const ReferenceField reference = read_field(name, near);
  SolveOptions options{.tolerance = tolerance, .sensors = {}, .diagnose = false};
  if (near)
    for (const View& view : reference.views) options.sensors.push_back(view.point);
  const auto solution = solve(placement, two_pi, reference.lights, options);
  const auto fields = solution.fields(reference.views);
  std::vector<Complex> found;
  for (std::size_t row = 0; row < reference.views.size(); ++row)
    found.push_back(fields[reference.light_of_row[row] * reference.views.size() + row]);
  return relative_distance(found, reference.field);
}

// Returns a bound of the error of the tables themselves (their README).
double table_error(const std::string& folder, const std::string& kind) {
  if (folder != "g10") return 1e-14;
  return kind == "N" ? 1e-10 : 3e-13;
}

// Orders must not be higher than necessary: the error is also above 1/1000 of the tolerance.
void check_cluster(const std::string& folder) {
  for (const std::string kind : {"D", "N", "TM15", "TE15", "TM15abs", "TE15abs"})
    for (const bool near : {false, true}) {
      const Placement placement = reference_placement(folder, kind);
      const std::string file = folder + (near ? "/nearfield_" : "/farfield_") + kind + ".csv";
      std::ostringstream line;
      for (const double tolerance : {1e-3, 1e-6, 1e-9, 1e-12}) {
        CAPTURE(file);
        CAPTURE(tolerance);
        const double error = error_against(file, near, placement, tolerance);
        CHECK(error < std::max(tolerance, table_error(folder, kind)));
        CHECK(error > tolerance / 1000);
        line << " " << error / tolerance;
      }
      MESSAGE(file << ", error / tolerance:" << line.str());
    }
}

double point_error(const std::string& file, double phase_shift, double tolerance) {
  Scatterer point;
  point.phase_shift = phase_shift;
  return error_against("p50/farfield_" + file + ".csv", false,
                       read_placement(reference_path("p50/placement.csv"), point), tolerance);
}

}  // namespace

TEST_CASE("reference fields: one disk off the origin") {
  check_cluster("g1");
}
TEST_CASE("reference fields: two disks") {
  check_cluster("g2");
}
TEST_CASE("reference fields: ten disks, smallest gap 0.043") {
  check_cluster("g10");
}

TEST_CASE("reference fields: fifty points, exact at any tolerance because there is no truncation") {
  for (const double tolerance : {1e-3, 1e-12}) {
    const double resonant = point_error("resonant_deltapi2", std::numbers::pi / 2, tolerance);
    const double weak = point_error("weak_delta0.3", 0.3, tolerance);
    MESSAGE("p50: relative L2 error resonant " << resonant << ", weak " << weak);
    CHECK(resonant <= 1e-12);
    CHECK(weak <= 1e-12);
  }
}

}  // namespace flatspeckle::wave::test_reference
