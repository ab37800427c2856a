#include "wave_solver/layered/layer_green.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/contract.h"
#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/numbers/gauss.h"
#include "core/numbers/hankel_array.h"
#include "wave_solver/dense/blas.h"
#include "wave_solver/equations/wave_equations.h"

namespace flatspeckle::wave {

namespace {

using std::numbers::pi;

// Steps of the tables, and extent of the corner table in wavelengths along and across the faces.
constexpr double steps_per_wavelength = 12, least_steps = 12, corner_refinement = 4,
                 corner_wavelengths = 1;

// The integral ends at largest_p times the larger wavenumber, or earlier where evanescent waves are
// below exp(-negligible_exponent).
constexpr double largest_p = 24, negligible_exponent = 32;

Complex hankel_0(double x) {
  Complex h;
  hankel0({&x, 1}, {&h, 1});
  return h;
}

/// Returns the real part of w^2 log w, w = z + i x. It is the transform of 1 / p^3 up to
/// polynomials.
double square_log(double x, double z) {
  const double square = x * x + z * z;
  if (square == 0) return 0;
  return (z * z - x * x) * std::log(square) / 2 - 2 * x * z * std::atan2(x, z);
}

}  // namespace

/// Quadrature node p with the weight of dp.
struct LayerGreen::Node {
  Complex p, weight;
};

/// Returns the contour of the integral. It passes below the branch points and the poles of guided
/// modes, which lie on the real axis, at a distance at which exp(i p x) grows little.
std::vector<LayerGreen::Node> LayerGreen::contour() const {
  const double most = std::max(waves_.k(), waves_.outside_k()),
               length = std::max(width_, 2 * waves_.depth()),
               below = std::min(3 / length, most / 4);
  const std::array<Complex, 4> corners{0, Complex(below, -below),
                                       Complex(1.05 * most + below, -below),
                                       Complex(1.05 * most + 3 * below)};
  static const QuadratureRule rule = gauss_legendre(16);
  std::vector<Node> nodes;
  const auto add_line = [&](Complex from, Complex to, double panel) {
    const int panels = std::max(1, static_cast<int>(std::ceil(std::abs(to - from) / panel)));
    const Complex step = (to - from) / double(panels);
    for (int j = 0; j < panels; ++j)
      for (std::size_t i = 0; i < rule.node.size(); ++i)
        nodes.push_back({from + (j + rule.node[i]) * step, rule.weight[i] * step});
  };
  for (int j = 0; j < 3; ++j) add_line(corners[j], corners[j + 1], 1.5 * below);
  add_line(corners[3], largest_p * most, 4 * below);
  return nodes;
}

/// Integrands of the tables at one node, without the cosine: waves that the faces reflect.
struct LayerGreen::Reflections {
  double depth;
  Complex p, along, before, mirrored, again, curved;

  Reflections(const LayerGreen& green, const Node& node)
      : depth(green.waves_.depth()), p(node.p), along(green.waves_.inside(p)) {
    const Complex r = green.waves_.reflected(p), around = r * r * propagated(along, 2 * depth),
                  measure = 2 / pi * node.weight / along,
                  lessened = (1.0 - std::exp(-p / green.waves_.k())) / p;
    before = measure * r / (1.0 - around);
    mirrored = before - measure * green.mirror_;
    again = before * r;
    curved = Complex(0, -2 / pi * green.curved_) * node.weight * lessened * lessened * lessened;
  }

  Complex wave(double z) const { return propagated(along, z); }
  /// Returns the part that both images in the faces emit, without image() and the terms of
  /// add_regular_images(). z: distance from the nearest image.
  Complex once(double z) const {
    return mirrored * wave(z) + before * wave(2 * depth - z) - curved * std::exp(-p * z);
  }
  /// Returns the part that both faces reflect. z: depth less the distance of the points along z.
  Complex twice(double z) const { return again * (wave(depth + z) + wave(3 * depth - z)); }
};

namespace {

double wavelength_of(const LayerWaves& waves) {
  return 2 * pi / waves.k();
}
double step_along_x(const LayerWaves& waves) {
  return wavelength_of(waves) / steps_per_wavelength;
}
double step_along_z(const LayerWaves& waves) {
  return std::min(step_along_x(waves), waves.depth() / least_steps);
}

/// Returns an empty table of the whole layer. Throws InputError if it is too large.
EvenTable layer_table(const LayerWaves& waves, double width) {
  const double x = step_along_x(waves), z = step_along_z(waves),
               bytes = 2 * EvenTable::bytes(width, waves.depth(), x, z);
  if (bytes > memory_of_system())
    throw InputError("width", width,
                     "the tables of waves that the faces reflect need " + number_text(bytes) +
                         " bytes; available bytes: " + number_text(memory_of_system()));
  return {width, waves.depth(), x, z};
}

EvenTable corner_table(const LayerWaves& waves, double size) {
  return {size, std::min(size, waves.depth()), step_along_x(waves) / corner_refinement,
          step_along_z(waves) / corner_refinement};
}

}  // namespace

LayerGreen::LayerGreen(const LayerWaves& waves, double width)
    : waves_(waves),
      width_(width),
      mirror_((1 - waves.derivative_ratio()) / (1 + waves.derivative_ratio())),
      curved_(-waves.derivative_ratio() * (waves.k() - waves.outside_k()) *
              (waves.k() + waves.outside_k()) / std::pow(1 + waves.derivative_ratio(), 2)),
      once_(layer_table(waves, width)),
      corner_(corner_table(waves, corner_wavelengths * wavelength_of(waves))),
      twice_(once_),
      corner_size_(corner_wavelengths * wavelength_of(waves)) {
  if (mirror_ == 0 && curved_ == 0) return;
  for (EvenTable* table : {&once_, &corner_}) {
    add_integrals(*table, 0, &Reflections::once);
    add_regular_images(*table);
  }
  add_integrals(twice_, waves.depth(), &Reflections::twice);
}

namespace {

/// Writes the cosines of p x for all columns. They follow from one another by rotation.
void write_cosines(Complex p, const EvenTable& table, Complex* cosines) {
  const Complex step = propagated(p, table.step_x()), back = 1.0 / step;
  Complex forward = propagated(p, table.x(0)), backward = 1.0 / forward;
  for (std::size_t x = 0; x < table.columns(); ++x) {
    cosines[x] = 0.5 * (forward + backward);
    forward = product(forward, step);
    backward = product(backward, back);
  }
}

/// Returns the number of rows of depth z in which exp(-decay (offset + z)) is not negligible.
std::size_t rows_within(double decay, double offset, const EvenTable& table) {
  std::size_t rows = 0;
  while (rows < table.rows() && decay * (offset + table.z(rows)) < negligible_exponent) ++rows;
  return rows;
}

}  // namespace

/// Adds the integral of a wave, times cos(p x), along the contour: products of a matrix of cosines
/// [node][x] and a matrix of waves [z][node]. Evanescent waves decay at least as exp(-|kz| (offset
/// + z)).
void LayerGreen::add_integrals(EvenTable& table, double offset,
                               Complex (Reflections::*wave)(double) const) const {
  constexpr std::size_t block = 128;
  const std::vector<Node> nodes = contour();
  std::vector<Complex> cosines(block * table.columns()), waves(block * table.rows());
  for (std::size_t first = 0; first < nodes.size(); first += block) {
    const std::size_t size = std::min(block, nodes.size() - first);
    // The decay of later nodes is larger.
    const std::size_t rows = rows_within(waves_.inside(nodes[first].p).imag(), offset, table);
    if (rows == 0) return;
    for (std::size_t n = 0; n < size; ++n) {
      const Reflections reflections(*this, nodes[first + n]);
      write_cosines(nodes[first + n].p, table, &cosines[n * table.columns()]);
      for (std::size_t z = 0; z < rows; ++z) waves[z * block + n] = (reflections.*wave)(table.z(z));
    }
    multiply(CblasNoTrans, CblasNoTrans, table.columns(), rows, size, 1, cosines.data(),
             table.columns(), waves.data(), block, 1, table.row(0), table.columns());
  }
}

/// Adds the closed form of the term with curved_ that Reflections::once() subtracts, (1 - exp(-p
/// a))^3 exp(-p z) / p^3 times a factor, without its singular part, which is in image().
void LayerGreen::add_regular_images(EvenTable& table) const {
  constexpr std::array<double, 4> third_difference{1, -3, 3, -1};
  for (std::size_t z = 0; z < table.rows(); ++z)
    for (std::size_t x = 0; x < table.columns(); ++x)
      for (int j = 1; j < 4; ++j)
        table.row(z)[x] += Complex(0, curved_ / pi) * third_difference[j] *
                           square_log(table.x(x), table.z(z) + j / waves_.k());
}

/// Returns the singular part of the reflected wave. x, z: separation from the mirror image.
Complex LayerGreen::image(double x, double z) const {
  Complex sum = Complex(0, curved_ / pi) * square_log(x, z);
  if (mirror_ != 0) sum += mirror_ * hankel_0(waves_.k() * std::hypot(x, z));
  return sum;
}

Complex LayerGreen::operator()(Vec p, Vec q) const {
  const double x = std::abs(p.x - q.x), depth = waves_.depth(),
               near = std::min(p.z + q.z, 2 * depth - p.z - q.z);
  FS_EXPECT(x <= width_ && near >= 0);
  const EvenTable& once = std::max(x, near) < corner_size_ ? corner_ : once_;
  const Complex reflected = image(x, near) + once(x, near) + twice_(x, depth - std::abs(p.z - q.z));
  return p == q ? reflected : reflected + hankel_0(waves_.k() * length(p - q));
}

}  // namespace flatspeckle::wave
