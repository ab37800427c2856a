#include "mc/paths/endpoint_factors/coherent_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "mc/paths/endpoint_factors/box_integral.h"

namespace flatspeckle::mc {

namespace {

/// Returns int_0^length exp(rate t) dt.
Complex exponential_integral(Complex rate, double length) {
  const Complex z = rate * length;
  if (std::abs(z) < 1e-4) return length * (1.0 + z / 2.0 + z * z / 6.0);
  return (std::exp(z) - 1.0) / rate;
}

/// Integrates f by eight-point Gauss-Legendre quadrature over equal panels. Their number is
/// `radians`, rounded up, plus one.
template <typename F>
Complex integrate(F f, double from, double to, double radians) {
  static constexpr std::array<double, 4> node = {0.1834346424956498, 0.5255324099163290,
                                                 0.7966664774136267, 0.9602898564975363};
  static constexpr std::array<double, 4> weight = {0.3626837833783620, 0.3137066458778873,
                                                   0.2223810344533745, 0.1012285362903763};
  const auto panels = static_cast<std::size_t>(std::ceil(radians)) + 1;
  const double half = (to - from) / (2 * static_cast<double>(panels));
  Complex sum = 0;
  for (std::size_t p = 0; p < panels; ++p) {
    const double middle = from + (2 * static_cast<double>(p) + 1) * half;
    for (std::size_t i = 0; i < node.size(); ++i)
      sum += weight[i] * (f(middle - half * node[i]) + f(middle + half * node[i]));
  }
  return half * sum;
}

constexpr double no_side = 1e300;   ///< distance to an edge that a ray never reaches
constexpr double parallel = 1e-12;  ///< cosine below which a ray is parallel to an edge

/// Ray segment from a place (x, z) along the unit vector u to the edge of the domain. Its length is
/// the smaller one of to_face(z), the distance to a face, and to_side(x), the distance to a side.
struct Segment {
  Vec u;
  double face, side;  ///< z of the face and x of the side

  Segment(const Domain& domain, Vec w)
      : u(w), face(w.z > 0 ? domain.depth : 0), side(std::copysign(domain.width / 2, w.x)) {}

  double to_face(double z) const { return std::abs(u.z) < parallel ? no_side : (face - z) / u.z; }
  double to_side(double x) const { return std::abs(u.x) < parallel ? no_side : (side - x) / u.x; }
  /// Returns the z at which to_face(z) = to_side(x). This z may lie outside the medium.
  double turn(double x) const { return face - u.z * to_side(x); }
};

/// Computes the integral over z of attenuated_wave_integral() at one x. The exponent of the
/// integrand is a linear function of z between the values of turn() of the segments.
Complex depth_column(const Domain& domain, Complex mu_t, double kappa_z,
                     std::span<const Segment> segments, double x) {
  constexpr std::size_t most_segments = 4;
  std::array<double, 2 + most_segments> cut{};
  cut[1] = domain.depth;
  for (std::size_t j = 0; j < segments.size(); ++j)
    cut[2 + j] = std::clamp(segments[j].turn(x), 0.0, domain.depth);
  std::sort(cut.begin(), cut.end());
  const auto exponent = [&](double z) {
    double length = 0;
    for (const Segment& segment : segments)
      length += std::min(segment.to_face(z), segment.to_side(x));
    return Complex(-mu_t.real() * length / 2, kappa_z * z - mu_t.imag() * length / 2);
  };
  Complex sum = 0, at_start = exponent(0);
  for (std::size_t i = 0; i + 1 < cut.size(); ++i) {
    const double thickness = cut[i + 1] - cut[i];
    if (thickness == 0) continue;
    const Complex at_end = exponent(cut[i + 1]);
    // The integral starts at the less attenuated end, so that nothing overflows.
    const Complex rate = (at_end - at_start) / thickness;
    sum += rate.real() > 0 ? std::exp(at_end) * exponential_integral(-rate, thickness)
                           : std::exp(at_start) * exponential_integral(rate, thickness);
    at_start = at_end;
  }
  return sum;
}

/// Returns the x at which the integral over z may have a kink as a function of x, and both sides of
/// the box. Kinks are where the turn() of a segment enters or leaves the medium, or where the
/// turn() of two segments cross.
std::vector<double> kinks(const Domain& domain, std::span<const Segment> segments) {
  const double half = domain.width / 2;
  std::vector<double> found = {-half, half};
  // Adds the x at which value + gradient x = 0
  const auto add = [&](double gradient, double value) {
    if (gradient == 0) return;
    if (const double x = -value / gradient; std::abs(x) < half) found.push_back(x);
  };
  // For each segment: the derivative of turn() with respect to x, and turn() at x = 0
  std::vector<std::array<double, 2>> turns;
  for (const Segment& segment : segments)
    if (std::abs(segment.u.x) >= parallel)
      turns.push_back({segment.u.z / segment.u.x, segment.turn(0)});
  for (std::size_t a = 0; a < turns.size(); ++a) {
    add(turns[a][0], turns[a][1]);
    add(turns[a][0], turns[a][1] - domain.depth);
    for (std::size_t b = 0; b < a; ++b) add(turns[a][0] - turns[b][0], turns[a][1] - turns[b][1]);
  }
  std::sort(found.begin(), found.end());
  return found;
}

/// Returns the argument `radians` of integrate(): a bound of the change of the exponent between two
/// neighbouring kinks (`from` and `to`), divided by three.
double radians(const Domain& domain, Complex mu_t, Vec kappa, std::span<const Segment> segments,
               double from, double to) {
  double sum = std::abs(kappa.x) * (to - from);
  for (const Segment& segment : segments) {
    if (std::abs(segment.u.x) < parallel) continue;
    const double moved = std::abs(std::clamp(segment.turn(to), 0.0, domain.depth) -
                                  std::clamp(segment.turn(from), 0.0, domain.depth));
    const double longest =
        std::min((to - from) / std::abs(segment.u.x),
                 std::abs(segment.u.z) < parallel ? no_side : domain.depth / std::abs(segment.u.z));
    sum += std::abs(kappa.z) * moved + std::abs(mu_t) * longest / 2;
  }
  return sum / 3;  // eight nodes resolve three radians
}

}  // namespace

Complex attenuated_wave_integral(const Domain& domain, Complex mu_t, Vec kappa,
                                 const std::vector<Vec>& towards) {
  if (domain.height > 0) return attenuated_wave_integral_in_space(domain, mu_t, kappa, towards);
  Domain box = domain;
  if (domain.kind == Domain::Kind::slab) box.width = no_side;
  std::vector<Segment> segments;
  for (const Vec w : towards) segments.emplace_back(box, w);
  if (domain.kind == Domain::Kind::slab) return depth_column(box, mu_t, kappa.z, segments, 0);
  const auto cut = kinks(box, segments);
  Complex sum = 0;
  for (std::size_t i = 0; i + 1 < cut.size(); ++i) {
    const auto integrand = [&](double x) {
      return std::polar(1.0, kappa.x * x) * depth_column(box, mu_t, kappa.z, segments, x);
    };
    if (cut[i + 1] > cut[i])
      sum += integrate(integrand, cut[i], cut[i + 1],
                       radians(box, mu_t, kappa, segments, cut[i], cut[i + 1]));
  }
  return sum;
}

bool has_coherent_field(const Scene& scene) {
  return scene.domain.kind == Domain::Kind::box && scene.medium.has_scatterers && !scene.profile &&
         (!scene.index || !scene.index->is_around()) &&
         scene.request.lights.all(Light::Kind::plane) &&
         std::none_of(scene.request.views.begin(), scene.request.views.end(),
                      [](const View& view) { return view.near; });
}

std::vector<Complex> coherent_field(const Scene& scene) {
  const BulkMedium& medium = scene.medium;
  std::vector<Complex> field;
  for (const auto [light, view] : scene.request.channels) {
    const Light& from = scene.request.lights[light];
    const View& to = scene.request.views[view];
    const Vec w = from.direction();
    const Complex scattered =
        medium.dimension == 3 ? amplitude_in_space(medium.t_matrix, scene.k, dot(w, to.direction()))
                              : amplitude(medium.t_matrix, scene.k, to.angle - from.angle);
    field.push_back(medium.density * scattered *
                    attenuated_wave_integral(scene.domain, {medium.mu_t, -2 * medium.k_shift},
                                             scene.k * (w - to.direction()), {-w}));
  }
  return field;
}

}  // namespace flatspeckle::mc
