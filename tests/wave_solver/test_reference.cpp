// Fixed placements against the tables of data/reference (its README says where they come from).

#include <algorithm>
#include <string>

#include <doctest/doctest.h>

#include "core/csv.h"
#include "reference.h"
#include "wave_solver/wave_solution.h"

namespace flatspeckle::wave {

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

double error_against(const std::string& name, bool near, const Placement& placement) {
  const ReferenceField reference = read_field(name, near);
  SolveOptions options{.sensors = {}, .diagnose = false};
  if (near)
    for (const View& view : reference.views) options.sensors.push_back(view.point);
  const auto solution = solve(placement, two_pi, reference.lights, options);
  const auto fields = solution.fields(reference.views);
  std::vector<Complex> found;
  for (std::size_t row = 0; row < reference.views.size(); ++row)
    found.push_back(fields[reference.light_of_row[row] * reference.views.size() + row]);
  return relative_distance(found, reference.field);
}

double accepted(const std::string& folder, const std::string& kind) {
  return folder == "g10" && kind == "N" ? 1e-9 : 1e-10;
}

void check_cluster(const std::string& folder) {
  for (const std::string kind : {"D", "N", "TM15", "TE15", "TM15abs", "TE15abs"}) {
    CAPTURE(folder);
    CAPTURE(kind);
    const Placement placement = reference_placement(folder, kind);
    const double far = error_against(folder + "/farfield_" + kind + ".csv", false, placement);
    const double near = error_against(folder + "/nearfield_" + kind + ".csv", true, placement);
    MESSAGE(folder << " " << kind << ": relative L2 error far " << far << ", near " << near);
    CHECK(far <= accepted(folder, kind));
    CHECK(near <= accepted(folder, kind));
  }
}

double point_error(const std::string& file, double phase_shift) {
  Scatterer point;
  point.phase_shift = phase_shift;
  return error_against("p50/farfield_" + file + ".csv", false,
                       read_placement(reference_path("p50/placement.csv"), point));
}

}  // namespace

TEST_CASE("one disk off the origin") {
  check_cluster("g1");
}
TEST_CASE("two disks") {
  check_cluster("g2");
}
TEST_CASE("ten disks, smallest gap 0.043") {
  check_cluster("g10");
}

TEST_CASE("fifty points") {
  const double resonant = point_error("resonant_deltapi2", std::numbers::pi / 2);
  const double weak = point_error("weak_delta0.3", 0.3);
  MESSAGE("p50: relative L2 error resonant " << resonant << ", weak " << weak);
  CHECK(resonant <= 1e-10);
  CHECK(weak <= 1e-10);
}

}  // namespace flatspeckle::wave
