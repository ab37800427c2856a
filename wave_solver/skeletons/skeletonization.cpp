#include "wave_solver/skeletons/skeletonization.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace flatspeckle::wave {

namespace {

constexpr std::size_t chunk = 128;  // rows that are formed at a time

// What a unit field, at most, excites in a body: its equations' size. Of cos n and sin n, one.
double largest_response(const WaveEquations& system) {
  double largest = 0;
  for (std::size_t j = 0; j < system.bodies().size(); ++j) {
    double response = system.strength(system.first(j));
    for (std::size_t unknown = system.first(j) + 1; unknown < system.first(j + 1); unknown += 2)
      response += system.strength(unknown);
    largest = std::max(largest, std::sqrt(response));
  }
  return largest;
}

}  // namespace

std::vector<Vec2> proxy_contour(const Rectangle& hull, double distance, double spacing) {
  const double quarter = distance * std::numbers::pi / 2;
  const double around = 2 * (hull.width() + hull.depth()) + 4 * quarter;
  const double step = around / std::ceil(around / spacing);
  struct Side {
    Vec2 end, along;
    double length;
  };
  const Side sides[] = {{{hull.high.x, hull.low.z}, {1, 0}, hull.width()},
                        {hull.high, {0, 1}, hull.depth()},
                        {{hull.low.x, hull.high.z}, {-1, 0}, hull.width()},
                        {hull.low, {0, -1}, hull.depth()}};
  std::vector<Vec2> points;
  double s = step / 2;  // along a side, then along the arc that follows it
  for (const auto& [end, along, length] : sides) {
    const Vec2 outward{along.z, -along.x};
    for (; s < length; s += step) points.push_back(end + (s - length) * along + distance * outward);
    for (s -= length; s < quarter; s += step)
      points.push_back(
          end + distance * (std::cos(s / distance) * outward + std::sin(s / distance) * along));
    s -= quarter;
  }
  return points;
}

Skeletonization::Skeletonization(const WaveEquations& system, double tolerance)
    : system_(system),
      tolerance_(tolerance),
      logarithm_(-std::log(tolerance)),
      weight_(largest_response(system)) {}

// Evanescent waves of the box fade as exp(-q distance): the contour needs about ln(1/tolerance) /
// pi points per distance, against density times distance near rows. Measured: half as much again
// costs less in rank than in rows.
double Skeletonization::distance(const ActiveBox& box) const {
  const double longer = std::max(box.hull.width(), box.hull.depth());
  const double shorter = std::min(box.hull.width(), box.hull.depth());
  const double area = longer * std::max(shorter, longer / 4);
  const double density = static_cast<double>(box.unknowns.size()) / area;
  return std::min(longer, 1.5 * std::sqrt(logarithm_ / (std::numbers::pi * density)));
}

Interpolation Skeletonization::operator()(const ActiveBox& box, std::span<const std::size_t> near,
                                          RandomStream random) const {
  if (box.unknowns.size() == 1) return {{0}, {}, {}};
  RowSketch sketch(box.unknowns.size(), random);
  add_near(box, near, sketch);
  add_contour(box, sketch);
  return interpolate(std::move(sketch), tolerance_);
}

// M is symmetric: the box's rows of the near columns are the near rows, transposed as wanted.
void Skeletonization::add_near(const ActiveBox& box, std::span<const std::size_t> near,
                               RowSketch& sketch) const {
  const std::size_t n = box.unknowns.size();
  std::vector<Complex> rows(n * chunk);
  for (std::size_t first = 0; first < near.size(); first += chunk) {
    const auto part = near.subspan(first, std::min(chunk, near.size() - first));
    system_.entries(box.unknowns, part, rows.data(), n);
    for (std::size_t i = 0; i < part.size(); ++i) sketch.add(std::span(rows).subspan(n * i, n));
  }
}

// Two points a wavelength tell all travelling waves along the contour. Evanescent ones are resolved
// up to exp(-q distance) = sqrt(tolerance), and folded onto slower ones beyond.
void Skeletonization::add_contour(const ActiveBox& box, RowSketch& sketch) const {
  const double reach = distance(box);
  const double spacing = std::numbers::pi / std::max(system_.k(), logarithm_ / (2 * reach));
  const auto points = proxy_contour(box.hull, reach, spacing);
  const std::size_t n = box.unknowns.size();
  std::vector<Complex> columns(n * chunk), row(n);
  for (std::size_t first = 0; first < points.size(); first += chunk) {
    const auto part = std::span(points).subspan(first, std::min(chunk, points.size() - first));
    system_.outgoing(part, box.unknowns, columns.data(), part.size());
    for (std::size_t i = 0; i < part.size(); ++i) {
      for (std::size_t j = 0; j < n; ++j) row[j] = weight_ * columns[i + part.size() * j];
      sketch.add(row);
    }
  }
}

}  // namespace flatspeckle::wave
