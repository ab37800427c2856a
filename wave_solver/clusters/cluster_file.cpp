#include "wave_solver/clusters/cluster_file.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/keys/csv.h"
#include "core/numbers/bessel.h"
#include "core/result/guarded_read.h"
#include "core/result/result_group.h"
#include "core/result/result_reader.h"
#include "wave_solver/solutions/light_solution.h"

namespace flatspeckle::wave {

const DatasetTable cluster_table{
    "solve --t_matrix_gap",
    {{"cluster/order", Data::scale, "", "1", "n of outgoing waves exp(i n phi) about the centre"},
     {"cluster/order_in", Data::scale, "", "1", "n of regular waves exp(i n phi)"},
     {"cluster/t_matrix", Data::complex, "cluster/order cluster/order_in", "1",
      "outgoing wave of the first order for a unit regular wave of the second"}},
    {{"cluster", "wavelength", "float64", "at which it holds"},
     {"cluster", "radius", "float64", "of the circle that holds the placement"},
     {"cluster", "gap", "float64", "from the circle to the nearest source"},
     {"cluster", "tolerance", "float64", "relative, of its fields"},
     {"cluster", "centre_x", "float64", "of the circle"},
     {"cluster", "centre_z", "float64", "of the circle"}}};

namespace {

// w_n of cluster_equations.h, of each mode.
std::vector<double> wave_sizes(const ClusterTMatrix& cluster) {
  std::vector<double> sizes;
  for (const Mode& mode : cluster.modes)
    sizes.push_back(
        static_cast<double>(mode.order == 0 ? mode.weight / ScaledReal(root_half) : mode.weight));
  return sizes;
}

// How much of a mode of order |n| is in J_n e^{i n phi}, J_{-n} = (-1)^n J_n: with
// e^{+-i n phi} = (cos +- i sin) / sqrt(2) of the modes sqrt(2) cos, sqrt(2) sin, a unitary change.
Complex share(int n, const Mode& mode) {
  if (n == 0) return 1;
  const double sign = n < 0 && n % 2 != 0 ? -1 : 1;
  const Complex sine(0, n > 0 ? 1 : -1);
  return sign * std::numbers::sqrt2 / 2 * (mode.odd ? sine : Complex(1));
}

// sum of out(i) entry(i, j) in(j)
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

// T_mn: [m][n], both -order .. order
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

// The way back.
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
      response[row + size * column] =
          combined(
              entry, mode_count(to.order), mode_count(from.order),
              [&](std::size_t i) { return share(order(to, i), to); },
              [&](std::size_t j) { return std::conj(share(order(from, j), from)); }) /
          (w[row] * w[column]);
    }
  return response;
}

KeptCluster read_file(const std::string& path) {
  const ResultReader file(path);
  const auto refuse = [&](const std::string& why) {
    throw InputError("cluster", path, why + "; must be a file that solve --t_matrix_gap wrote");
  };
  if (!file.has("cluster/t_matrix")) refuse("holds no T-matrix");
  const auto number = [&](const char* name) { return file.attribute<double>("cluster", name); };
  const double wavelength = number("wavelength"), radius = number("radius"), gap = number("gap");
  const auto t = file.dataset<Complex>("cluster/t_matrix");
  const auto shape = file.shape("cluster/t_matrix");
  KeptCluster kept{{}, {number("centre_x"), number("centre_z")}, number("tolerance")};
  for (const double value : {wavelength, radius, gap, kept.tolerance})
    if (!std::isfinite(value) || !(value > 0)) refuse("has numbers that are not positive");
  if (shape.size() != 2 || shape[0] != shape[1] || shape[0] % 2 == 0 || shape[0] > 2001)
    refuse("has a T-matrix that is not square, of odd size");
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
  const Vec2 centre = enclosing_circle(placement).centre;
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
  const Table table = read_csv(path, {"x", "z", "angle"});
  std::vector<ClusterPlace> places;
  for (std::size_t row = 0; row < table.rows(); ++row)
    places.push_back({{table.column("x")[row], table.column("z")[row]},
                      table.has("angle") ? table.column("angle")[row] : 0});
  return places;
}

}  // namespace flatspeckle::wave
