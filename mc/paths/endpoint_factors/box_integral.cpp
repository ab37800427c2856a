#include "mc/paths/endpoint_factors/box_integral.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

namespace flatspeckle::mc {

namespace {

/// The half-space on one side of a plane: normal.x <= limit.
struct HalfSpace {
  Vec normal;
  double limit = 0;

  double excess(Vec x) const { return dot(normal, x) - limit; }
};

/// A convex body, given by its faces, which are polygons.
class ConvexBody {
 public:
  using Polygon = std::vector<Vec>;

  explicit ConvexBody(const Domain& box)
      : rounding_(1e-14 * std::max({box.width, box.height, box.depth})) {
    const double x = box.width / 2, y = box.height / 2;
    const auto add = [&](Vec corner, Vec along, Vec across) {
      faces_.push_back({corner, corner + along, corner + along + across, corner + across});
    };
    const Vec to_x{box.width}, to_z{0, box.depth}, to_y{0, 0, box.height};
    const Vec low{-x, 0, -y}, high{x, box.depth, y};
    add(low, to_x, to_z);
    add(low, to_z, to_y);
    add(low, to_y, to_x);
    add(high, -to_x, -to_z);
    add(high, -to_z, -to_y);
    add(high, -to_y, -to_x);
  }

  bool is_empty() const { return faces_.empty(); }

  /// Keeps the part of the body in a half-space. Slices thinner than rounding are dropped.
  void clip(const HalfSpace& half) {
    double low = 0, high = 0;
    const double tolerance = rounding_ * length(half.normal);
    for (const Polygon& face : faces_)
      for (const Vec x : face) {
        low = std::min(low, half.excess(x));
        high = std::max(high, half.excess(x));
      }
    if (high <= tolerance) return;
    if (low >= -tolerance) return faces_.clear();
    Polygon cut;
    std::vector<Polygon> kept;
    for (const Polygon& face : faces_) {
      Polygon part = clipped(face, half, cut);
      if (part.size() > 2) kept.push_back(std::move(part));
    }
    if (cut.size() > 2) kept.push_back(in_order(cut, half.normal));
    faces_ = std::move(kept);
  }

  /// Calls f with the corners of each tetrahedron of a division of the body.
  template <typename F>
  void each_tetrahedron(const F& f) const {
    if (is_empty()) return;
    const Vec apex = faces_.front().front();
    for (const Polygon& face : faces_) {
      if (std::ranges::find(face, apex) != face.end()) continue;
      for (std::size_t i = 1; i + 1 < face.size(); ++i)
        f(std::array<Vec, 4>{apex, face[0], face[i], face[i + 1]});
    }
  }

 private:
  /// Returns the part of a polygon in the half-space, and adds the points at which its border
  /// crosses the plane to `cut`.
  static Polygon clipped(const Polygon& face, const HalfSpace& half, Polygon& cut) {
    Polygon part;
    for (std::size_t i = 0; i < face.size(); ++i) {
      const Vec a = face[i], b = face[(i + 1) % face.size()];
      const double from = half.excess(a), to = half.excess(b);
      if (from <= 0) part.push_back(a);
      if (from == 0) cut.push_back(a);
      if ((from < 0 && to > 0) || (from > 0 && to < 0)) {
        // Equal arithmetic for both faces at an edge gives equal points.
        const bool forward = from < 0;
        const Vec inner = forward ? a : b, outer = forward ? b : a;
        const double low = forward ? from : to, high = forward ? to : from;
        part.push_back(inner + low / (low - high) * (outer - inner));
        cut.push_back(part.back());
      }
    }
    return part;
  }

  /// Returns the points of a convex polygon in their order around its middle, each once.
  static Polygon in_order(const Polygon& points, Vec normal) {
    Vec middle;
    for (const Vec x : points) middle = middle + 1 / static_cast<double>(points.size()) * x;
    const Vec first = points.front() - middle, second = cross(normal, first);
    const double scale = length(normal);
    std::vector<std::pair<double, Vec>> turned;
    for (const Vec x : points)
      turned.emplace_back(std::atan2(dot(second, x - middle), scale * dot(first, x - middle)), x);
    std::ranges::sort(turned);
    Polygon ordered;
    for (const auto& [angle, x] : turned)
      if (ordered.empty() || x != ordered.back()) ordered.push_back(x);
    return ordered;
  }

  double rounding_;  ///< of coordinates
  std::vector<Polygon> faces_;
};

/// Distance to a side of the box along a ray, as a function of the ray's start.
struct BoxSide {
  double Vec::*axis;
  double place = 0, cosine = 0;

  double distance(Vec x) const { return (place - x.*axis) / cosine; }
  /// Returns the half-space in which this side is not further away than the other.
  HalfSpace before(const BoxSide& other) const {
    HalfSpace half;
    // place - x over cosine, multiplied by both cosines, which are positive in magnitude
    const double own = std::abs(other.cosine), others = std::abs(cosine);
    const double sign = std::copysign(1, cosine), other_sign = std::copysign(1, other.cosine);
    half.normal.*axis = -sign * own;
    half.normal.*(other.axis) = other_sign * others;
    half.limit = other_sign * others * other.place - sign * own * place;
    return half;
  }
};

/// Returns the sides that a ray along w can reach.
std::vector<BoxSide> sides_along(const Domain& box, Vec w) {
  constexpr double parallel = 1e-12;
  std::vector<BoxSide> sides;
  const auto add = [&](double Vec::*axis, double low, double high) {
    if (std::abs(w.*axis) > parallel) sides.push_back({axis, w.*axis > 0 ? high : low, w.*axis});
  };
  add(&Vec::z, 0, box.depth);
  add(&Vec::x, -box.width / 2, box.width / 2);
  add(&Vec::y, -box.height / 2, box.height / 2);
  return sides;
}

/// Sums the integral over the parts of the box, which it finds by dividing the box for one
/// direction after the other.
class Parts {
 public:
  Parts(const Domain& box, Complex mu_t, Vec kappa, const std::vector<Vec>& towards)
      : mu_t_(mu_t), kappa_(kappa) {
    for (const Vec w : towards) directions_.push_back(sides_along(box, w));
  }

  Complex sum(const ConvexBody& body) {
    const std::size_t next = chosen_.size();
    if (next == directions_.size()) return integral(body);
    // Equal directions leave by the same side.
    for (std::size_t i = 0; i < next; ++i)
      if (same(directions_[i], directions_[next])) return with(chosen_[i], body);
    Complex total = 0;
    for (const BoxSide& side : directions_[next]) {
      ConvexBody part = body;
      for (const BoxSide& other : directions_[next])
        if (other.axis != side.axis && !part.is_empty()) part.clip(side.before(other));
      if (!part.is_empty()) total += with(side, part);
    }
    return total;
  }

 private:
  static bool same(const std::vector<BoxSide>& a, const std::vector<BoxSide>& b) {
    return std::ranges::equal(a, b, [](const BoxSide& one, const BoxSide& other) {
      return one.axis == other.axis && one.cosine == other.cosine;
    });
  }

  Complex with(BoxSide side, const ConvexBody& body) {
    chosen_.push_back(side);
    const Complex found = sum(body);
    chosen_.pop_back();
    return found;
  }

  Complex integral(const ConvexBody& body) const {
    Complex total = 0;
    body.each_tetrahedron([&](const std::array<Vec, 4>& corner) {
      Complex exponents[4];
      for (std::size_t i = 0; i < 4; ++i) exponents[i] = exponent(corner[i]);
      const double volume6 =
          std::abs(dot(corner[1] - corner[0], cross(corner[2] - corner[0], corner[3] - corner[0])));
      total += volume6 * divided_difference(exponents);
    });
    return total;
  }

  Complex exponent(Vec x) const {
    double length = 0;
    for (const BoxSide& side : chosen_) length += std::max(0.0, side.distance(x));
    return Complex(0, dot(kappa_, x)) - mu_t_ * length / 2.0;
  }

  Complex mu_t_;
  Vec kappa_;
  std::vector<std::vector<BoxSide>> directions_;
  std::vector<BoxSide> chosen_;  ///< the sides of the first directions in the present part
};

/// Computes the divided difference of exp at points within a distance of about 1 from each other,
/// from the Taylor series about their mean.
Complex close_difference(std::span<const Complex> points) {
  Complex mean = 0;
  for (const Complex z : points) mean += z / static_cast<double>(points.size());
  // sums[j]: complete homogeneous symmetric polynomial of the current degree of the first j + 1
  // points, relative to the mean
  std::array<Complex, 4> sums;
  sums.fill(1);
  double factorial = 1;
  for (std::size_t n = 2; n < points.size(); ++n) factorial *= static_cast<double>(n);
  Complex total = 1 / factorial;
  constexpr int most_terms = 24;
  for (int degree = 1; degree < most_terms; ++degree) {
    factorial *= degree + static_cast<double>(points.size()) - 1;
    Complex before = 0;
    for (std::size_t j = 0; j < points.size(); ++j)
      before = sums[j] = before + product(points[j] - mean, sums[j]);
    total += before / factorial;
  }
  return std::exp(mean) * total;
}

Complex difference(std::span<Complex> points) {
  const std::size_t n = points.size();
  if (n == 1) return std::exp(points[0]);
  std::size_t first = 0, last = 1;
  double widest = -1;
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = a + 1; b < n; ++b)
      if (const double apart = std::norm(points[a] - points[b]); apart > widest) {
        widest = apart;
        first = a;
        last = b;
      }
  if (widest < 1) return close_difference(points);
  std::swap(points[0], points[first]);
  std::swap(points[n - 1], points[last]);
  const Complex apart = points[n - 1] - points[0];
  std::array<Complex, 4> low, high;
  std::copy_n(points.begin(), n - 1, low.begin());
  std::copy_n(points.begin() + 1, n - 1, high.begin());
  return (difference(std::span(high).first(n - 1)) - difference(std::span(low).first(n - 1))) /
         apart;
}

}  // namespace

Complex divided_difference(const Complex (&points)[4]) {
  std::array<Complex, 4> own{points[0], points[1], points[2], points[3]};
  return difference(own);
}

Complex attenuated_wave_integral_in_space(const Domain& box, Complex mu_t, Vec kappa,
                                          const std::vector<Vec>& towards) {
  return Parts(box, mu_t, kappa, towards).sum(ConvexBody(box));
}

}  // namespace flatspeckle::mc
