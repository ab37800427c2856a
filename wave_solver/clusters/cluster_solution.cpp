#include "wave_solver/clusters/cluster_solution.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/result/result_group.h"
#include "flatland/scene/scene_datasets.h"
#include "wave_solver/dense/blas.h"
#include "wave_solver/dense/columns.h"

namespace flatspeckle::wave {

const DatasetTable cluster_solution_table{
    "solve --cluster",
    {{"far_field", Data::complex, "light_angle view_angle", "length^(1/2)",
      "far-field amplitude A, phase origin at r = 0"},
     {"near_field", Data::complex, "light_angle sensor", "1",
      "scattered field, without the incident wave"},
     {"copy", Data::numbers, "", "1", "number of the copy"},
     {"places/x", Data::real, "copy", "length", "transverse position of the centre"},
     {"places/z", Data::real, "copy", "length", "depth of the centre"},
     {"places/angle", Data::real, "copy", "rad", "by which the cluster is turned"},
     {"solve/unknowns", Data::count, "", "1", "of the equations"},
     {"solve/residual", Data::real, "", "1", "relative residual of the unscaled equations"},
     {"solve/condition", Data::real, "", "1",
      "condition of the scaled matrix, Frobenius norm, estimated"}}};

namespace {

Circle circle_of(const ClusterEquations& equations) {
  if (equations.bodies().empty()) return {};
  const auto [low, high] = bounds_of(equations.bodies(), &WaveEquations::Body::centre);
  return {0.5 * (low + high), length(0.5 * (high - low)) + equations.bodies()[0].radius};
}

void require_off(const ClusterTMatrix& cluster, const std::vector<ClusterPlace>& places,
                 const std::vector<Vec2>& sensors) {
  const double least = cluster.radius + cluster.gap;
  for (const Vec2& sensor : sensors)
    for (const auto& [centre, angle] : places)
      if (!(length(sensor - centre) >= least))
        throw InputError("near_sensors",
                         "(" + number_text(sensor.x) + ", " + number_text(sensor.z) + ")",
                         "must be at least " + number_text(least) +
                             ", radius and gap, from the centre of every cluster");
}

// Columns times the response of each copy, in place.
void respond(const ClusterTMatrix& cluster, const std::vector<ClusterPlace>& places, Complex factor,
             Complex* columns, std::size_t count) {
  const std::size_t size = cluster.modes.size(), unknowns = size * places.size();
  std::vector<Complex> rows(size * count);
  for (std::size_t j = 0; j < places.size(); ++j) {
    for (std::size_t column = 0; column < count; ++column)
      std::copy_n(columns + unknowns * column + size * j, size, &rows[size * column]);
    multiply(CblasNoTrans, CblasNoTrans, size, count, size, factor,
             cluster.turned(places[j].angle).data(), size, rows.data(), size, 0, columns + size * j,
             unknowns);
  }
}

double norm(const std::vector<Complex>& values) {
  double sum = 0;
  for (const Complex& value : values) sum += std::norm(value);
  return std::sqrt(sum);
}

// b - T S b = T a; equations: of S alone, right sides -a. All turned so that the diagonal is large
// for LAPACK, which measures pivots by |re| + |im|: factors may grow without bound otherwise.
LightSolution pivoted(const ClusterEquations& equations, const ClusterTMatrix& cluster,
                      const std::vector<ClusterPlace>& places,
                      const std::vector<double>& light_angles, double tolerance) {
  const std::size_t n = equations.unknowns();
  const Complex turned = std::polar(1.0, std::numbers::pi / 4);
  Entries matrix = equations.matrix();
  respond(cluster, places, -turned, matrix.data(), n);
  for (std::size_t i = 0; i < n; ++i) matrix[i * (n + 1)] += turned;
  auto sides = equations.right_sides(light_angles);
  respond(cluster, places, -1, sides.data(), light_angles.size());
  LightSolution found{sides, {}, "dense LU with pivoting"};
  for (Complex& side : found.coefficients) side *= turned;
  std::vector<lapack_int> pivots(n);
  const auto size = static_cast<lapack_int>(n);
  if (LAPACKE_zgesv(LAPACK_COL_MAJOR, size, static_cast<lapack_int>(light_angles.size()),
                    matrix.data(), size, pivots.data(), found.coefficients.data(), size) != 0)
    throw std::runtime_error("clusters: singular equations");
  auto left = equations.apply(found.coefficients);
  respond(cluster, places, 1, left.data(), light_angles.size());
  for (std::size_t i = 0; i < left.size(); ++i) left[i] += sides[i] - found.coefficients[i];
  const double asked = norm(sides);
  found.diagnosis.residual = asked > 0 ? norm(left) / asked : 0;
  if (!(found.diagnosis.residual <= 100 * std::max(tolerance, 1e-12)))
    throw std::runtime_error("clusters: not solved, residual " +
                             number_text(found.diagnosis.residual));
  return found;
}

ClusterEquations equations_of(const ClusterTMatrix& cluster,
                              const std::vector<ClusterPlace>& places,
                              const SolveOptions& options) {
  const ScaledInverse inverse = scaled_inverse(cluster);
  if (inverse.lost <= options.tolerance) return {cluster, places, inverse};
  if (options.method == Method::fast || options.method == Method::krylov)
    throw InputError(
        "solver: the cluster's T-matrix is too nearly singular (inverted and back it is off by " +
        number_text(inverse.lost) +
        ") for any but dense; make it with a wider gap or a larger tolerance");
  return {cluster, places};
}

}  // namespace

ClusterSolution::ClusterSolution(const ClusterTMatrix& cluster, std::vector<ClusterPlace> places,
                                 std::vector<double> light_angles, const SolveOptions& options)
    : places_(std::move(places)),
      light_angles_(std::move(light_angles)),
      equations_(equations_of(cluster, places_, options)) {
  require_off(cluster, places_, options.sensors);
  found_ = equations_.are_whole()
               ? solve_lights(equations_, light_angles_, circle_of(equations_), options)
               : pivoted(equations_, cluster, places_, light_angles_, options.tolerance);
  require_finite(found_.coefficients);
}

std::vector<Complex> ClusterSolution::fields(const std::vector<View>& views) const {
  return transposed_product(equations_.view_rows(views), found_.coefficients.data(),
                            light_angles_.size(), equations_.unknowns());
}

void write_solution(ResultFile& file, const ClusterSolution& solution,
                    const std::vector<double>& view_angles, const std::vector<Vec2>& sensors) {
  const ResultGroup root(file, cluster_solution_table);
  write_light_axis(file, solution.light_angles());
  const auto put = [&](const std::string& name, const std::vector<View>& views) {
    if (views.empty()) return;
    write_view_axis(file, views);
    root.put(name, solution.fields(views));
  };
  put("far_field", column(view_angles, far_view));
  put("near_field", column(sensors, near_sensor));
  const auto& places = solution.places();
  root.number("copy", places.size());
  root.put("places/x", column(places, [](const auto& place) { return place.centre.x; }));
  root.put("places/z", column(places, [](const auto& place) { return place.centre.z; }));
  root.put("places/angle", column(places, &ClusterPlace::angle));
  root.put("solve/unknowns", std::uint64_t(solution.equations().unknowns()));
  root.put("solve/residual", solution.diagnosis().residual);
  if (solution.diagnosis().condition >= 0)
    root.put("solve/condition", solution.diagnosis().condition);
}

}  // namespace flatspeckle::wave
