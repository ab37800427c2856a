#include "wave_solver/graded/graded_fields.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/error.h"
#include "core/keys/number_text.h"
#include "wave_solver/points/foldy_lax.h"

namespace flatspeckle::wave {

namespace {

constexpr double below_rounding = -38;  // natural logarithm of a negligible value
constexpr Complex imaginary{0, 1};

/// Values of cot z, tan(z / 2) and (z / sin z)^(1/2). The square root is the branch that is 1 at z
/// = 0, continued through the upper half-plane, where it has no branch cut.
struct Sines {
  Complex cotangent, half_tangent, root;

  explicit Sines(Complex z) {
    const bool below = z.imag() < 0;
    if (below) z = std::conj(z);
    z.imag() < 1 ? from_sine(z) : from_exponential(z);
    if (!below) return;
    cotangent = std::conj(cotangent);
    half_tangent = std::conj(half_tangent);
    root = std::conj(root);
  }

 private:
  void from_sine(Complex z) {
    const Complex sine = std::sin(z);
    cotangent = std::cos(z) / sine;
    half_tangent = std::tan(0.5 * z);
    root = std::sqrt(z / sine);
    if (z.real() > std::numbers::pi)
      from_exponential(z);  // the square root above is on the wrong branch
  }
  void from_exponential(Complex z) {
    const Complex turn = std::exp(imaginary * z), square = turn * turn;
    cotangent = imaginary * (square + 1.0) / (square - 1.0);
    half_tangent = -imaginary * (turn - 1.0) / (turn + 1.0);
    root = std::sqrt(2.0 * z / imaginary) * std::exp(0.5 * imaginary * z) / std::sqrt(1.0 - square);
  }
};

/// Returns the parameter sigma (C23) of the direct ray from p to q in a parabolic guide: the
/// smallest sigma for which the ray has |v|^2 = n^2 at p (v = dx/dsigma). Newton's method, started
/// below this sigma, converges monotonically.
std::optional<double> sigma_in_guide(const IndexField& field, Vec p, Vec q) {
  const double deep = q.z - p.z, square = field.square(p);
  const double most = std::sqrt(std::max({square, field.square(q), field.origin * field.origin}));
  double sigma = std::hypot(deep, q.x - p.x) / most;
  for (int step = 0; step < 100; ++step) {
    const double angle = field.alpha * sigma, sine = std::sin(angle), cosine = std::cos(angle);
    if (!(angle < std::numbers::pi)) return std::nullopt;
    const double half = std::sin(angle / 2), moved = q.x - p.x + 2 * p.x * half * half;
    const double across = field.alpha * moved / sine, along = deep / sigma;
    const double derivative =
        2 * across * field.alpha * (field.alpha * p.x - across * cosine / sine) -
        2 * along * along / sigma;
    if (!(derivative < 0)) return std::nullopt;
    const double excess = across * across + along * along - square,
                 next = sigma - excess / derivative;
    if (std::abs(next - sigma) < 1e-9 * sigma) return next;  // the contour tolerates a small error
    sigma = next;
  }
  return std::nullopt;
}

std::vector<Vec> sources_of(const CovarianceRequest& request) {
  if (!request.lights.all(Light::Kind::point))
    throw InputError("index_field: the exact solver of graded media requires near_sources only");
  std::vector<Vec> sources;
  for (const Light& light : request.lights) sources.push_back(light.point);
  return sources;
}

std::vector<Vec> sensors_of(const CovarianceRequest& request) {
  std::vector<Vec> sensors;
  for (const View& view : request.views) {
    if (!view.near)
      throw InputError("index_field: the exact solver of graded media requires near_sensors only");
    sensors.push_back(view.point);
  }
  return sensors;
}

/// Returns the largest distance between two of the points.
double longest_distance(const std::vector<Vec>& places) {
  double longest = 0;
  for (const Vec a : places)
    for (const Vec b : places) longest = std::max(longest, length(a - b));
  return longest;
}

template <typename T>
std::vector<T> concatenated(std::vector<T> list, const std::vector<T>& rest) {
  list.insert(list.end(), rest.begin(), rest.end());
  return list;
}

}  // namespace

GradedGreen::GradedGreen(const IndexField& field, double k, double longest) : field_(field), k_(k) {
  if (!field.is_quadratic())
    throw InputError("index_field", field.describe(),
                     "has no exact solver; use a linear or parabolic field");
  constexpr double fine = 0.04, most = 40, turn = 0.8;
  step_ = std::min(fine, 0.4 / std::sqrt(k * longest));
  for (double u = 0; u < most; u += step_) {
    const double tanh = std::tanh(u);
    time_.push_back(std::exp(Complex(u, turn * tanh)));
    weight_.push_back(Complex(step_, step_ * turn * (1 - tanh * tanh)));
  }
}

std::optional<double> GradedGreen::sigma(Vec p, Vec q) const {
  if (field_.kind == IndexField::Kind::parabolic) return sigma_in_guide(field_, p, q);
  const Vec separation = q - p;
  const double square = dot(separation, separation),
               mean = (field_.square(p) + field_.square(q)) / 2,
               root = mean * mean - dot(field_.gradient, field_.gradient) * square / 4;
  if (!(root > 0 && mean > 0)) return std::nullopt;
  return std::sqrt(2 * square / (mean + std::sqrt(root)));
}

void GradedGreen::refuse(Vec p, Vec q) const {
  const auto text = [](Vec x) { return '(' + number_text(x.x) + ", " + number_text(x.z) + ')'; };
  throw InputError(
      "index_field", field_.describe(),
      "bends rays so much that the direct wave between " + text(p) + " and " + text(q) +
          " cannot be separated from returning waves; use a weaker field, or a smaller "
          "box with closer sources and sensors");
}

Complex GradedGreen::operator()(Vec p, Vec q) const {
  const auto along = sigma(p, q);
  if (!along) refuse(p, q);
  const double t0 = *along / (2 * k_);
  const bool guide = field_.kind == IndexField::Kind::parabolic;
  const Vec separation = q - p;
  const double mean = (field_.square(p) + field_.square(q)) / 2,
               force = k_ * k_ * length(field_.gradient);
  const double across = guide ? separation.z * separation.z : dot(separation, separation),
               square = guide ? field_.origin * field_.origin : mean;
  const double near = across / (4 * t0), far = k_ * k_ * square * t0,
               cube = guide ? 0 : force * force * t0 * t0 * t0 / 12;
  const double omega = k_ * field_.alpha;
  // Returns the integrand at the complex time t t0: the exponential times its prefactor. real:
  // receives the real part of the exponent.
  const auto value = [&](Complex t, double& real) {
    Complex power = imaginary * (near / t + far * t - cube * t * t * t), before = 1;
    if (guide) {
      const Sines sines(2 * omega * t0 * t);
      power += imaginary * (omega / 2) *
               (separation.x * separation.x * sines.cotangent - 2 * p.x * q.x * sines.half_tangent);
      before = sines.root;
    }
    real = power.real();
    return before * std::exp(power);
  };
  Complex sum = 0;
  for (const bool up : {true, false}) {
    double before = 1, real = 0;
    for (std::size_t j = up ? 0 : 1; j < time_.size(); ++j) {
      sum += weight_[j] * value(up ? time_[j] : 1.0 / time_[j], real);
      if (real < below_rounding) break;
      if (real > before + 1e-9) refuse(p, q);
      before = real;
    }
  }
  return sum / (4 * std::numbers::pi);
}

const DatasetTable graded_table{
    "solve in a graded medium",
    {{"near_source_field", Data::complex, "light sensor", "1",
      "scattered field of a point source, the Green function, in a graded medium"}}};

GradedFields::GradedFields(const IndexField& field, double k, std::vector<Vec> sources,
                           std::vector<Vec> sensors, const std::vector<Vec>& within)
    : k_(k),
      sources_(std::move(sources)),
      sensors_(std::move(sensors)),
      green_(field, k, longest_distance(concatenated(concatenated(within, sources_), sensors_))) {
  for (const Vec place : within)
    for (const auto* others : {&within, &std::as_const(sources_), &std::as_const(sensors_)})
      for (const Vec other : *others)
        if (other != place) green_(place, other);
}

GradedFields graded_fields(const Scene& scene) {
  const double half = scene.domain.width / 2, depth = scene.domain.depth;
  return {*scene.index,
          scene.k,
          sources_of(scene.request),
          sensors_of(scene.request),
          {{-half, 0}, {half, 0}, {-half, depth}, {half, depth}}};
}

/// Returns -4 i G between each point and each scatterer, [point][scatterer]. In a uniform medium -4
/// i G is H_0.
std::vector<Complex> GradedFields::rows(const Placement& placement,
                                        const std::vector<Vec>& points) const {
  std::vector<Complex> rows;
  for (const Vec point : points)
    for (const PlacedScatterer& placed : placement)
      rows.push_back(Complex(0, -4) * green_(placed.position, point));
  return rows;
}

std::vector<Complex> GradedFields::of(const Placement& placement) const {
  if (placement.empty()) return std::vector<Complex>(sources_.size() * sensors_.size());
  auto lights = rows(placement, sources_);
  for (Complex& field : lights) field *= Complex(0, 0.25);  // G, the field of a source
  const auto wave = [&](Vec p, Vec q) {
    return p == q ? Complex(0) : Complex(0, -4) * green_(p, q);
  };
  return foldy_lax(placement, k_, wave, lights, rows(placement, sensors_));
}

}  // namespace flatspeckle::wave
