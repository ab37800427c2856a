#include "grin/rays/surfaces/aspheric_lens.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "grin/rays/surfaces/straight_crossing.h"

namespace flatspeckle::grin {

namespace {

constexpr int samples = 400;  // of the radius, by which properties of a face are found

/// Calls use(u) for values of u = rho^2 from 0 to radius^2, evenly spaced in rho.
template <class Use>
void each_zone(double radius, const Use& use) {
  for (int i = 0; i <= samples; ++i) {
    const double rho = radius * i / samples;
    use(rho * rho);
  }
}

/// Returns the largest magnitude of the gradient of z - sag up to the radius, with a margin for the
/// places between the samples; nullopt if the face does not extend to the radius.
std::optional<double> steepness_of(const AsphericFace& face, double radius) {
  constexpr double margin = 1.05;
  if (!((1 + face.conic) * std::pow(face.curvature * radius, 2) <= 1)) return std::nullopt;
  double steepest = 0;
  each_zone(radius * (1 - 1e-9), [&](double u) {
    steepest = std::max(steepest, 2 * std::abs(face.sag(u).first) * std::sqrt(u));
  });
  constexpr double most = 1e4;
  if (!(steepest < most)) return std::nullopt;
  return std::hypot(1, margin * steepest);
}

/// Returns a zero of f between a and b, where f has different signs, by false position (Illinois)
/// and bisection.
template <class Function>
double zero_between(const Function& f, double a, double fa, double b, double fb) {
  double weight_a = 1, weight_b = 1;  // reduced for an end that is kept repeatedly
  for (int i = 0; i < 200; ++i) {
    const double ga = weight_a * fa, gb = weight_b * fb, part = ga / (ga - gb);
    double middle = a + (b - a) * (part > 0 && part < 1 ? part : 0.5);
    if (middle <= a || middle >= b) middle = (a + b) / 2;
    if (middle <= a || middle >= b) break;
    const double value = f(middle);
    if (value == 0) return middle;
    const bool replaces_a = (value > 0) == (fa > 0);
    (replaces_a ? a : b) = middle;
    (replaces_a ? fa : fb) = value;
    weight_a = replaces_a ? 1 : weight_a / 2;
    weight_b = replaces_a ? weight_b / 2 : 1;
  }
  return std::abs(fa) < std::abs(fb) ? a : b;
}

}  // namespace

AsphericFace::Sag AsphericFace::sag(double u) const {
  const double c = curvature, q = (1 + conic) * c * c;
  const double root = std::sqrt(std::max(1 - q * u, 1e-12));
  Sag sag{c * u / (1 + root), c / (2 * root), c * q / (4 * root * root * root)};
  double power = u;  // u^(i + 1)
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const auto order = static_cast<double>(i + 2);
    sag.value += terms[i] * power * u;
    sag.first += order * terms[i] * power;
    sag.second += order * (order - 1) * terms[i] * (u > 0 ? power / u : (i == 0 ? 1 : 0));
    power *= u;
  }
  return sag;
}

std::optional<AsphericLens> AsphericLens::make(const Vec3& vertex, double radius,
                                               const AsphericFace& front, const AsphericFace& back,
                                               double thickness) {
  const auto of_front = steepness_of(front, radius), of_back = steepness_of(back, radius);
  if (!of_front || !of_back || !(thickness > 0)) return std::nullopt;
  bool meet = false;
  each_zone(radius, [&](double u) {
    meet |= !(thickness + back.sag(u).value - front.sag(u).value >= -1e-12 * thickness);
  });
  if (meet) return std::nullopt;
  return AsphericLens(
      vertex, radius,
      {{{front, vertex[2], -1, *of_front}, {back, vertex[2] + thickness, 1, *of_back}}});
}

AsphericLens::AsphericLens(const Vec3& vertex, double radius, const std::array<Face, 2>& faces)
    : vertex_(vertex), radius_(radius), faces_(faces) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  each_zone(radius, [&](double u) {
    low = std::min(low, faces[0].vertex + faces[0].shape.sag(u).value);
    high = std::max(high, faces[1].vertex + faces[1].shape.sag(u).value);
  });
  bounds_ = {{vertex[0] - radius, vertex[1] - radius, low},
             {vertex[0] + radius, vertex[1] + radius, high}};
  constexpr int zones = 2000;
  for (int i = 0; i < zones; ++i) {
    const double u = radius * radius * (i + 0.5) / zones;
    volume_ += std::numbers::pi * radius * radius / zones *
               (faces[1].vertex + faces[1].shape.sag(u).value - faces[0].vertex -
                faces[0].shape.sag(u).value);
  }
}

double AsphericLens::squared_rho(const Vec3& x) const {
  const double dx = x[0] - vertex_[0], dy = x[1] - vertex_[1];
  return dx * dx + dy * dy;
}

double AsphericLens::height(const Face& face, const Vec3& x) const {
  const double u = std::min(squared_rho(x), radius_ * radius_);
  return face.outwards * (x[2] - face.vertex - face.shape.sag(u).value);
}

double AsphericLens::barrel_distance(const Vec3& x) const {
  return distance_from_sphere({x[0], x[1], 0}, {vertex_[0], vertex_[1], 0}, radius_);
}

double AsphericLens::distance(const Vec3& x) const {
  double most = barrel_distance(x);
  for (const Face& face : faces_) most = std::max(most, height(face, x) / face.steepness);
  return most;
}

const AsphericLens::Face* AsphericLens::face_at(const Vec3& x) const {
  const double front = height(faces_[0], x), back = height(faces_[1], x);
  if (barrel_distance(x) > std::max(front, back)) return nullptr;
  return &faces_[front < back];
}

Vec3 AsphericLens::gradient(const Face& face, const Vec3& x) const {
  const double by_u = -2 * face.shape.sag(squared_rho(x)).first;
  return face.outwards * Vec3(by_u * (x[0] - vertex_[0]), by_u * (x[1] - vertex_[1]), 1);
}

Vec3 AsphericLens::normal(const Vec3& x) const {
  if (const Face* const face = face_at(x)) return gradient(*face, x).normalized();
  return Vec3(x[0] - vertex_[0], x[1] - vertex_[1], 0).normalized();
}

Mat3 AsphericLens::curvature(const Vec3& x) const {
  const Vec3 n = normal(x), across(x[0] - vertex_[0], x[1] - vertex_[1], 0);
  const Face* const face = face_at(x);
  if (!face)
    return (Mat3::Identity() - n * n.transpose() - Vec3::UnitZ() * Vec3::UnitZ().transpose()) /
           radius_;
  const AsphericFace::Sag sag = face->shape.sag(across.squaredNorm());
  Mat3 second = -4 * sag.second * across * across.transpose();
  second(0, 0) -= 2 * sag.first;
  second(1, 1) -= 2 * sag.first;
  second *= face->outwards;
  return (second - n * (n.transpose() * second)) / gradient(*face, x).norm();
}

double AsphericLens::crossing_distance(const Vec3& x, const Vec3& d, bool leaves) const {
  constexpr int parts = 64;
  const double size = (bounds_.high - bounds_.low).norm();
  const double rounding = 1e-11 * size + crossing_accuracy(x);
  // Part of the line inside the cylinder
  const Vec3 from(x[0] - vertex_[0], x[1] - vertex_[1], 0), along(d[0], d[1], 0);
  const double a = along.squaredNorm(), b = from.dot(along),
               c = from.squaredNorm() - radius_ * radius_;
  double in = -rounding, out = no_crossing;
  if (a > 0) {
    const double under = b * b - a * c;
    if (!(under > 0)) return no_crossing;
    in = std::max(in, (-b - std::sqrt(under)) / a);
    out = (-b + std::sqrt(under)) / a;
  } else if (c >= 0) {
    return no_crossing;
  }
  // Beyond the planes around the lens, there is no face
  const double far = 2 * size + (x - (bounds_.low + bounds_.high) / 2).norm();
  const bool enters_barrel = in > -rounding;
  const double last = std::min(out, far);
  if (!(in < last)) return no_crossing;
  const auto inside_at = [&](double t, const Face* but) {
    return std::ranges::all_of(faces_, [&](const Face& face) {
      return &face == but || height(face, x + t * d) < rounding;
    });
  };
  double first = no_crossing;
  if (leaves && out >= -rounding) first = out;
  if (!leaves && enters_barrel && inside_at(in, nullptr)) first = in;
  // Faces lie in a short part of a long line
  const double near = std::max(in, entry_distance(bounds_, x, d) < no_crossing
                                       ? entry_distance(bounds_, x, d) - rounding
                                       : in);
  const double end = std::min(last, near + 1.01 * size);
  for (const Face& face : faces_) {
    const auto at = [&](double t) { return height(face, x + t * d); };
    double before = near, value = at(before);
    for (int i = 1; i <= parts && before < first; ++i) {
      const double after = near + (end - near) * i / parts, next = at(after);
      if ((value > 0) != (next > 0) && (next > 0) == leaves) {
        const double t = zero_between(at, before, value, after, next);
        if (t < first && (leaves || inside_at(t, &face))) first = t;
      }
      before = after;
      value = next;
    }
  }
  return first < no_crossing ? std::max(0.0, first) : no_crossing;
}

}  // namespace flatspeckle::grin
