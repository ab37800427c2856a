#include "wave_solver/clusters/cluster_solution.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "core/error.h"
#include "core/keys/csv.h"
#include "core/keys/number_text.h"
#include "core/numbers/bessel.h"
#include "core/result/guarded_read.h"
#include "core/result/result_group.h"
#include "core/result/result_reader.h"
#include "flatland/scene/scene_datasets.h"
#include "wave_solver/dense/blas.h"
#include "wave_solver/dense/dense_factor.h"
#include "wave_solver/solutions/equation_solver.h"

namespace flatspeckle::wave {

const DatasetTable cluster_table{
    "solve --t_matrix_gap",
    {{"cluster/order", Data::scale, "", "1",
      "order n of the outgoing waves exp(i n phi) about the centre"},
     {"cluster/order_in", Data::scale, "", "1", "order n of the regular waves exp(i n phi)"},
     {"cluster/t_matrix", Data::complex, "cluster/order cluster/order_in", "1",
      "amplitude of the outgoing wave (order) for a unit regular wave (order_in)"}},
    {{"cluster", "wavelength", "float64", "wavelength of the T-matrix"},
     {"cluster", "radius", "float64", "radius of the circle that encloses the placement"},
     {"cluster", "gap", "float64", "distance from the circle to the nearest source"},
     {"cluster", "tolerance", "float64", "relative error of the fields"},
     {"cluster", "centre_x", "float64", "x of the circle's centre"},
     {"cluster", "centre_z", "float64", "z of the circle's centre"}}};

namespace {

// Returns w_n (cluster_equations.h) of each mode.
std::vector<double> wave_sizes(const ClusterTMatrix& cluster) {
  std::vector<double> sizes;
  for (const Mode& mode : cluster.modes)
    sizes.push_back(
        static_cast<double>(mode.order == 0 ? mode.weight / ScaledReal(root_half) : mode.weight));
  return sizes;
}

// Returns the coefficient of a real mode of order |n| in the wave J_n e^{i n phi}, where J_{-n} =
// (-1)^n J_n. In the modes c = sqrt(2) cos(n phi) and s = sqrt(2) sin(n phi), e^{+-i n phi} is (c
// +- i s) / sqrt(2), so that the transform is unitary.
Complex share(int n, const Mode& mode) {
  if (n == 0) return 1;
  const double sign = n < 0 && n % 2 != 0 ? -1 : 1;
  const Complex sine(0, n > 0 ? 1 : -1);
  return sign * std::numbers::sqrt2 / 2 * (mode.odd ? sine : Complex(1));
}

// Returns the sum over i and j of out(i) entry(i, j) in(j).
template <typename Entry, typename Out, typename In>
Complex combined(const Entry& entry, std::size_t rows, std::size_t columns, const Out& out,
                 const In& in) {
  Complex sum = 0;
  for (std::size_t i = 0; i < rows; ++i)
    for (std::size_t j = 0; j < columns; ++j) sum += out(i) * entry(i, j) * in(j);
  return sum;
}

std::size_t first_mode(int n) {
  return n == 0 ? 0 : 2 * std::abs(n) - 1;
}
std::size_t mode_count(int n) {
  return n == 0 ? 1 : 2;
}

// Returns the T-matrix for the waves e^{i n phi}: T_mn as [m][n], with m and n from -order to
// order.
std::vector<Complex> angular(const ClusterTMatrix& cluster) {
  const int last = cluster.order;
  const std::size_t size = cluster.modes.size();
  const auto w = wave_sizes(cluster);
  std::vector<Complex> t;
  for (int m = -last; m <= last; ++m)
    for (int n = -last; n <= last; ++n) {
      const std::size_t row = first_mode(m), column = first_mode(n);
      const auto entry = [&](std::size_t i, std::size_t j) {
        return w[row + i] * w[column + j] * cluster.response[row + i + size * (column + j)];
      };
      t.push_back(combined(
          entry, mode_count(m), mode_count(n),
          [&](std::size_t i) { return std::conj(share(m, cluster.modes[row + i])); },
          [&](std::size_t j) { return share(n, cluster.modes[column + j]); }));
    }
  return t;
}

// Converts T_mn back to the response in real modes: the inverse of angular().
std::vector<Complex> response_of(const ClusterTMatrix& cluster, const std::vector<Complex>& t) {
  const int last = cluster.order;
  const std::size_t size = cluster.modes.size();
  const auto w = wave_sizes(cluster);
  std::vector<Complex> response(size * size);
  for (std::size_t row = 0; row < size; ++row)
    for (std::size_t column = 0; column < size; ++column) {
      const Mode &to = cluster.modes[row], &from = cluster.modes[column];
      const auto order = [&](const Mode& mode, std::size_t i) {
        return i == 0 ? mode.order : -mode.order;
      };
      const auto entry = [&](std::size_t i, std::size_t j) {
        return t[(last + order(to, i)) * size + last + order(from, j)];
      };
      const Complex sum = combined(
          entry, mode_count(to.order), mode_count(from.order),
          [&](std::size_t i) { return share(order(to, i), to); },
          [&](std::size_t j) { return std::conj(share(order(from, j), from)); });
      // The product of both sizes may underflow, as does T_mn where it is written as 0.
      response[row + size * column] = sum == 0.0 ? sum : sum / w[row] / w[column];
    }
  return response;
}

KeptCluster read_file(const std::string& path) {
  const ResultReader file(path);
  const auto refuse = [&](const std::string& why) {
    throw InputError("cluster", path, why + "; must be a file written by solve --t_matrix_gap");
  };
  if (!file.has("cluster/t_matrix")) refuse("contains no T-matrix");
  const auto number = [&](const char* name) { return file.attribute<double>("cluster", name); };
  const double wavelength = number("wavelength"), radius = number("radius"), gap = number("gap");
  const auto t = file.dataset<Complex>("cluster/t_matrix");
  const auto shape = file.shape("cluster/t_matrix");
  KeptCluster kept{{}, {number("centre_x"), number("centre_z")}, number("tolerance")};
  for (const double value : {wavelength, radius, gap, kept.tolerance})
    if (!std::isfinite(value) || !(value > 0)) refuse("has attributes that are not positive");
  if (shape.size() != 2 || shape[0] != shape[1] || shape[0] % 2 == 0 || shape[0] > 2001)
    refuse("has a T-matrix that is not square with an odd size");
  if (!std::ranges::all_of(t, [](const Complex& value) {
        return std::isfinite(value.real()) && std::isfinite(value.imag());
      }))
    refuse("has numbers that are not finite");
  const double k = 2 * std::numbers::pi / wavelength;
  kept.t_matrix = cluster_waves(k, radius, gap, static_cast<int>(shape[0] / 2));
  kept.t_matrix.response = response_of(kept.t_matrix, t);
  return kept;
}

}  // namespace

KeptCluster kept_cluster(const Placement& placement, double k, double gap, double tolerance) {
  const Vec centre = enclosing_circle(placement).centre;
  Placement about = placement;
  for (auto& placed : about) placed.position = placed.position - centre;
  return {cluster_t_matrix(about, k, gap, tolerance), centre, tolerance};
}

void write_cluster(ResultFile& file, const KeptCluster& cluster) {
  const ResultGroup root(file, cluster_table);
  const ClusterTMatrix& t = cluster.t_matrix;
  std::vector<double> orders;
  for (int n = -t.order; n <= t.order; ++n) orders.push_back(n);
  root.put("cluster/order", orders);
  root.put("cluster/order_in", orders);
  root.put("cluster/t_matrix", angular(t));
  const auto attribute = [&](const char* name, double value) {
    root.attribute("cluster", name, value);
  };
  attribute("wavelength", 2 * std::numbers::pi / t.k);
  attribute("radius", t.radius);
  attribute("gap", t.gap);
  attribute("tolerance", cluster.tolerance);
  attribute("centre_x", cluster.centre.x);
  attribute("centre_z", cluster.centre.z);
}

KeptCluster read_cluster(const std::string& path) {
  return guarded_read(path, [&] { return read_file(path); });
}

std::vector<ClusterPlace> read_places(const std::string& path) {
  const Table table = read_key_table("placement", path, {"x", "z", "angle"});
  std::vector<ClusterPlace> places;
  for (std::size_t row = 0; row < table.rows(); ++row)
    places.push_back({{table.column("x")[row], table.column("z")[row]},
                      table.has("angle") ? table.column("angle")[row] : 0});
  return places;
}

const DatasetTable cluster_solution_table{
    "solve --cluster",
    {{"far_field", Data::complex, "light_angle view_angle", "length^(1/2)",
      "far-field amplitude A, phase origin at r = 0"},
     {"near_field", Data::complex, "light_angle sensor", "1",
      "scattered field, without the incident wave"},
     {"copy", Data::numbers, "", "1", "number of the copy"},
     {"places/x", Data::real, "copy", "length", "transverse position of the centre"},
     {"places/z", Data::real, "copy", "length", "depth of the centre"},
     {"places/angle", Data::real, "copy", "rad", "rotation angle of the cluster"},
     {"solve/unknowns", Data::count, "", "1", "number of unknowns of the equations"},
     {"solve/residual", Data::real, "", "1", "relative residual of the unscaled equations"},
     {"solve/condition", Data::real, "", "1",
      "estimated condition number of the scaled matrix, in the Frobenius norm"}}};

namespace {

Circle circle_of(const ClusterEquations& equations) {
  if (equations.bodies().empty()) return {};
  const auto [low, high] = bounds_of(equations.bodies(), &WaveEquations::Body::centre);
  return {0.5 * (low + high), length(0.5 * (high - low)) + equations.bodies()[0].radius};
}

void require_off(const ClusterTMatrix& cluster, const std::vector<ClusterPlace>& places,
                 const std::vector<Vec>& sensors) {
  const double least = cluster.radius + cluster.gap;
  for (const Vec& sensor : sensors)
    for (const auto& [centre, angle] : places)
      if (!(length(sensor - centre) >= least))
        throw InputError("near_sensors",
                         "(" + number_text(sensor.x) + ", " + number_text(sensor.z) + ")",
                         "must be at least " + number_text(least) +
                             " (radius and gap) from the centre of every cluster");
}

// For each copy of the cluster, replaces its rows of `columns` by `factor` times the response of
// the copy times these rows.
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

// Solves b - T S b = T a by LU with pivoting; `equations` contains only S and the right-hand sides
// -a. Both sides are multiplied by a phase factor, which makes the diagonal large in LAPACK's
// measure of pivots, |re| + |im|. Without this factor, elements of L and U may grow without bound.
LightSolution pivoted(const ClusterEquations& equations, const ClusterTMatrix& cluster,
                      const std::vector<ClusterPlace>& places,
                      const std::vector<double>& light_angles, double tolerance) {
  const std::size_t n = equations.unknowns();
  const Complex turned = std::polar(1.0, std::numbers::pi / 4);
  Entries matrix = equations.matrix();
  respond(cluster, places, -turned, matrix.data(), n);
  for (std::size_t i = 0; i < n; ++i) matrix[i * (n + 1)] += turned;
  auto rhs = equations.right_hand_sides(light_angles);
  respond(cluster, places, -1, rhs.data(), light_angles.size());
  LightSolution found{rhs, {}, "dense LU with pivoting"};
  for (Complex& side : found.coefficients) side *= turned;
  std::vector<lapack_int> pivots(n);
  const auto size = static_cast<lapack_int>(n);
  if (LAPACKE_zgesv(LAPACK_COL_MAJOR, size, static_cast<lapack_int>(light_angles.size()),
                    matrix.data(), size, pivots.data(), found.coefficients.data(), size) != 0)
    throw std::runtime_error("the multiple-scattering equations of the clusters are singular");
  auto left = equations.apply(found.coefficients);
  respond(cluster, places, 1, left.data(), light_angles.size());
  for (std::size_t i = 0; i < left.size(); ++i) left[i] += rhs[i] - found.coefficients[i];
  const double rhs_norm = norm(rhs);
  found.diagnosis.residual = rhs_norm > 0 ? norm(left) / rhs_norm : 0;
  if (!(found.diagnosis.residual <= 100 * std::max(tolerance, 1e-12)))
    throw std::runtime_error(
        "the multiple-scattering equations of the clusters were not solved: relative residual " +
        number_text(found.diagnosis.residual));
  return found;
}

ClusterEquations equations_of(const ClusterTMatrix& cluster,
                              const std::vector<ClusterPlace>& places,
                              const SolveOptions& options) {
  const ScaledInverse inverse = scaled_inverse(cluster);
  if (inverse.inversion_error <= options.tolerance) return {cluster, places, inverse};
  if (options.method == Method::fast || options.method == Method::krylov)
    throw InputError(
        "solver: the cluster's T-matrix is nearly singular (relative inversion error " +
        number_text(inverse.inversion_error) +
        ") for fast and krylov; use dense, or make the T-matrix with a wider gap or a larger "
        "tolerance");
  return {cluster, places};
}

}  // namespace

ClusterSolution::ClusterSolution(const ClusterTMatrix& cluster, std::vector<ClusterPlace> places,
                                 std::vector<double> light_angles, const SolveOptions& options)
    : places_(std::move(places)),
      light_angles_(std::move(light_angles)),
      equations_(equations_of(cluster, places_, options)) {
  require_off(cluster, places_, options.sensors);
  found_ = equations_.have_inverse()
               ? solve_lights(equations_, light_angles_, circle_of(equations_), options)
               : pivoted(equations_, cluster, places_, light_angles_, options.tolerance);
  require_finite(found_.coefficients);
}

std::vector<Complex> ClusterSolution::fields(const std::vector<View>& views) const {
  return transposed_product(equations_.view_rows(views), found_.coefficients.data(),
                            light_angles_.size(), equations_.unknowns());
}

void write_solution(ResultFile& file, const ClusterSolution& solution,
                    const std::vector<double>& view_angles, const std::vector<Vec>& sensors) {
  const ResultGroup root(file, cluster_solution_table);
  write_light_axis(file, solution.light_angles());
  const auto put = [&](const std::string& name, const std::vector<View>& views) {
    if (views.empty()) return;
    write_view_axis(file, views);
    root.put(name, solution.fields(views));
  };
  put("far_field", far_views(view_angles));
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
