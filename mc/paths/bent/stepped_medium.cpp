#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "core/error.h"
#include "core/keys/number_text.h"
#include "grin/media/fields/gaussian_blobs.h"
#include "grin/media/fields/parabolic.h"
#include "grin/media/fields/spline_field.h"
#include "grin/media/fields/ultrasound.h"
#include "mc/paths/bent/bent_chords.h"
#include "mc/paths/bent/graded_medium.h"

namespace flatspeckle::mc {

namespace {

using Four = std::array<double, 4>;

/// Returns the weights of cubic Hermite interpolation at t: two for the values at 0 and 1, then two
/// for the derivatives at 0 and 1.
Four hermite(double t) {
  const double u = 1 - t;
  return {u * u * (1 + 2 * t), t * t * (3 - 2 * t), t * u * u, -t * t * u};
}
Four hermite_derivative(double t) {
  return {-6 * t * (1 - t), 6 * t * (1 - t), (1 - t) * (1 - 3 * t), t * (3 * t - 2)};
}
/// Returns the weights of cubic convolution at t, for the values at -1, 0, 1 and 2.
Four convolution(double t) {
  const double u = 1 - t;
  return {-t * u * u / 2, (2 - 5 * t * t + 3 * t * t * t) / 2, (2 - 5 * u * u + 3 * u * u * u) / 2,
          -t * t * u / 2};
}

std::size_t cells(double extent, double spacing) {
  constexpr double least = 4, most = 400;
  return static_cast<std::size_t>(std::clamp(std::ceil(extent / spacing), least, most));
}

constexpr int most_steps = 100000;

grin::Vec3 in_space(Vec x) {
  return {x.x, 0, x.z};
}

/// A wave tabulated over a box. The eikonal (optical path) is interpolated from its values and
/// gradients by bicubic Hermite polynomials, the amplitude by cubic convolution.
class WaveTable : public Wavefront {
 public:
  /// Node of the table: the arrival at a place, and the index n at this place.
  struct Node {
    Arrival arrival;
    double index;
  };
  /// Computes the node at x; nullopt if no ray reaches it. guess: the node of a neighbouring place,
  /// or null.
  using At = std::function<std::optional<Node>(Vec x, const Node* guess)>;
  /// spreads: whether the wave comes from a point, so that its amplitude falls approximately as
  /// path^(-1/2). whose: the light or view, for messages. Throws InputError for a node that no ray
  /// reaches.
  WaveTable(const Domain& box, double spacing, bool spreads, const At& at, const std::string& whose)
      : box_(box),
        spreads_(spreads),
        columns_(cells(box.width, spacing) + 3),
        rows_(cells(box.depth, spacing) + 3) {
    dx_ = box.width / static_cast<double>(columns_ - 3);
    dz_ = box.depth / static_cast<double>(rows_ - 3);
    origin_ = {-box.width / 2 - dx_, -dz_};
    std::vector<Node> row(columns_);
    for (std::size_t j = 0; j < rows_; ++j)
      for (std::size_t i = 0; i < columns_; ++i) {
        const Vec x = origin_ + Vec{static_cast<double>(i) * dx_, static_cast<double>(j) * dz_};
        const Node* guess = j > 0 ? &row[i] : i > 0 ? &row[i - 1] : nullptr;
        const auto node = at(x, guess);
        if (!node)
          throw InputError("index_field: light of " + whose + " does not reach (" +
                           number_text(x.x) + ", " + number_text(x.z) +
                           ") by exactly one ray, because of a caustic; take a weaker field, a "
                           "smaller box or other endpoints");
        row[i] = *node;
        const auto& [w, path, amplitude, inside, launch] = node->arrival;
        const double chord = box.contains(x) ? box.distance_to_edge(x, -w) : 0;
        entries_.push_back({path, node->index * w.x, node->index * w.z, 0,
                            std::log(spreads ? amplitude * std::sqrt(path) : amplitude),
                            chord > 1e-9 * dx_ ? inside / chord : 1 / node->index, launch});
      }
    find_mixed_derivatives();
  }

  std::optional<Arrival> at(Vec x) const override {
    const double along = (x.x - origin_.x) / dx_, deep = (x.z - origin_.z) / dz_;
    const auto cell = [](double position, std::size_t size) {
      return static_cast<std::size_t>(std::clamp(position, 1.0, static_cast<double>(size - 3)));
    };
    const std::size_t i = cell(along, columns_), j = cell(deep, rows_);
    const double s = along - static_cast<double>(i), t = deep - static_cast<double>(j);
    const Four a = hermite(s), b = hermite(t), da = hermite_derivative(s),
               db = hermite_derivative(t), p = convolution(s), q = convolution(t);
    Arrival found{{}, 0, 0, 0, 0};
    Vec v{0, 0};
    for (std::size_t m = 0; m < 2; ++m)
      for (std::size_t n = 0; n < 2; ++n) {
        const Entry& e = entry(i + m, j + n);
        const double sx = dx_ * e.by_x, sz = dz_ * e.by_z, both = dx_ * dz_ * e.by_both;
        found.path +=
            a[m] * (b[n] * e.path + b[2 + n] * sz) + a[2 + m] * (b[n] * sx + b[2 + n] * both);
        v.x +=
            (da[m] * (b[n] * e.path + b[2 + n] * sz) + da[2 + m] * (b[n] * sx + b[2 + n] * both)) /
            dx_;
        v.z += (a[m] * (db[n] * e.path + db[2 + n] * sz) +
                a[2 + m] * (db[n] * sx + db[2 + n] * both)) /
               dz_;
        const double share = (m == 0 ? 1 - s : s) * (n == 0 ? 1 - t : t);
        found.inside += share * e.inside_per_chord;
        found.launch += share * e.launch;
      }
    double log_amplitude = 0;
    for (std::size_t m = 0; m < 4; ++m)
      for (std::size_t n = 0; n < 4; ++n)
        log_amplitude += p[m] * q[n] * entry(i + m - 1, j + n - 1).log_amplitude;
    found.w = 1 / length(v) * v;
    found.amplitude = std::exp(log_amplitude) / (spreads_ ? std::sqrt(found.path) : 1);
    found.inside *= box_.distance_to_edge(x, -found.w);
    return found;
  }

 private:
  struct Entry {
    double path, by_x, by_z, by_both, log_amplitude, inside_per_chord, launch;
  };
  const Entry& entry(std::size_t i, std::size_t j) const { return entries_[j * columns_ + i]; }

  /// Computes the mixed second derivative by_both from differences of by_x along z. The outermost
  /// rows take the values of the rows next to them.
  void find_mixed_derivatives() {
    for (std::size_t j = 0; j < rows_; ++j)
      for (std::size_t i = 0; i < columns_; ++i) {
        const std::size_t middle = std::clamp<std::size_t>(j, 1, rows_ - 2);
        entries_[j * columns_ + i].by_both =
            (entry(i, middle + 1).by_x - entry(i, middle - 1).by_x) / (2 * dz_);
      }
  }

  Domain box_;
  bool spreads_;
  Vec origin_;
  double dx_, dz_;
  /// Number of nodes along x and z; one node on each side lies outside the box
  std::size_t columns_, rows_;
  std::vector<Entry> entries_;
};

/// Square n^2 of the index at a place in the plane y = 0, and the force n grad n, which bends rays
/// (C30).
struct Bend {
  double square;
  Vec force;
};
/// A Bend with the derivatives of its force: xx and xz of force.x with respect to x and z, zz of
/// force.z with respect to z.
struct BendDerivatives : Bend {
  double xx, xz, zz;
};

/// A ray in the parameter sigma (conventions, C30): x' = v, v' = n grad n, |v| = n.
struct BentRay {
  Vec x, v;
};

/// A ray, its optical path, and the derivatives of its place and velocity with respect to the
/// initial angle.
struct RayTube : BentRay {
  Vec y, w;  ///< derivatives of x and v with respect to the initial angle
  double path = 0;

  static RayTube from(Vec x, Vec v) { return {{x, v}, {}, {v.z, -v.x}, 0}; }
  /// Returns the geometric spreading J (C32), whose sign changes at caustics.
  double spread() const { return y.x * v.z - y.z * v.x; }
};

/// Advances a ray by a step h in sigma, by the fourth-order method of Nystrom.
template <typename BendAt>
BentRay stepped(const BentRay& ray, double h, const BendAt& bend) {
  const auto [x, v] = ray;
  const Vec a = bend(x).force, b = bend(x + h / 2 * v + h * h / 8 * a).force,
            c = bend(x + h * v + h * h / 2 * b).force;
  return {x + h * v + h * h / 6 * (a + 2 * b), v + h / 6 * (a + 4 * b + c)};
}

/// Advances a ray tube by a step h. The derivatives y and w follow from differentiating the step of
/// the ray, the optical path from Simpson's rule.
template <typename BendDerivativesAt>
RayTube stepped(const RayTube& tube, double h, const BendDerivativesAt& bend) {
  const auto turned = [](const BendDerivatives& at, Vec y) {
    return Vec{at.xx * y.x + at.xz * y.z, at.xz * y.x + at.zz * y.z};
  };
  const Vec x = tube.x, v = tube.v, y = tube.y, w = tube.w;
  const BendDerivatives first = bend(x);
  const Vec a = first.force, ya = turned(first, y);
  const BendDerivatives second = bend(x + h / 2 * v + h * h / 8 * a);
  const Vec b = second.force, yb = turned(second, y + h / 2 * w + h * h / 8 * ya);
  const BendDerivatives third = bend(x + h * v + h * h / 2 * b);
  const Vec c = third.force, yc = turned(third, y + h * w + h * h / 2 * yb);
  RayTube next;
  next.x = x + h * v + h * h / 6 * (a + 2 * b);
  next.v = v + h / 6 * (a + 4 * b + c);
  next.y = y + h * w + h * h / 6 * (ya + 2 * yb);
  next.w = w + h / 6 * (ya + 4 * yb + yc);
  next.path = tube.path + h / 6 * (first.square + 4 * second.square + third.square);
  return next;
}

template <class Field>
class SteppedMedium;

/// Wave of a point source in the medium or near it. Each call of at() searches for the ray to the
/// place.
template <class Field>
class SearchedWave : public Wavefront {
 public:
  SearchedWave(const SteppedMedium<Field>& medium, Vec source) : medium_(medium), source_(source) {}

  std::optional<Arrival> at(Vec x) const override {
    const auto node = medium_.arrival(source_, x, std::nullopt);
    if (!node) return std::nullopt;
    return node->arrival;
  }

 private:
  const SteppedMedium<Field>& medium_;
  Vec source_;
};

double distance_to(const Domain& box, Vec x) {
  return std::hypot(std::max(0.0, std::abs(x.x) - box.width / 2),
                    std::max({0.0, -x.z, x.z - box.depth}));
}

/// Medium of any grin index field in the plane y = 0, in which rays are integrated in steps
/// (stepped_medium()).
template <class Field>
class SteppedMedium : public GradedMedium {
 public:
  SteppedMedium(const Scene& scene, Field field) : domain_(scene.domain), field_(std::move(field)) {
    constexpr double step_per_scale = 0.25, spacing_per_scale = 0.25, step_per_box = 0.125;
    const double scale = facts(field_).scale, size = std::max(domain_.width, domain_.depth),
                 least = std::min(domain_.width, domain_.depth);
    step_ = std::min(step_per_scale * scale, step_per_box * size);
    spacing_ = std::min(spacing_per_scale * scale, least / 8);
    low_ = {-domain_.width / 2, 0};
    high_ = {domain_.width / 2, domain_.depth};
    const auto take = [&](Vec x) {
      low_ = {std::min(low_.x, x.x), std::min(low_.z, x.z)};
      high_ = {std::max(high_.x, x.x), std::max(high_.z, x.z)};
    };
    for (const Light& light : scene.request.lights)
      if (light.kind == Light::Kind::point) take(light.point);
    for (const View& view : scene.request.views)
      if (view.near) take(view.point);
    low_ = low_ - Vec{size, size};
    high_ = high_ + Vec{size, size};
  }

  double square(Vec x) const override { return bend(x).square; }

  double inside(Vec x, Vec w) const override {
    BentRay ray = begun(x, w);
    double sum = 0;
    for (int step = 0; step < most_steps && in_window(ray.x); ++step) {
      const BentRay next = stepped(ray, step_, [this](Vec place) { return bend(place); });
      sum += chords(ray, next, step_).length();
      ray = next;
    }
    return sum;
  }

  std::optional<RayPlace> after_flight(Vec x, Vec w, double sigma) const override {
    const auto bend_at = [this](Vec place) { return bend(place); };
    BentRay ray = begun(x, w);
    for (int step = 0; step < most_steps && in_window(ray.x); ++step) {
      const BentRay next = stepped(ray, step_, bend_at);
      const BentChords parts = chords(ray, next, step_);
      if (const double at = parts.at(sigma); at <= step_) {
        const BentRay end = stepped(ray, at, bend_at);
        return RayPlace{end.x, 1 / length(end.v) * end.v};
      }
      sigma -= parts.length();
      ray = next;
    }
    return std::nullopt;
  }

  /// Finds the ray from a source to a place. guess: an estimate of the angle of the ray at the
  /// source.
  std::optional<WaveTable::Node> arrival(Vec source, Vec x, std::optional<double> guess) const {
    const Vec chord = x - source;
    const double middle = angle_of(Vec{0, domain_.depth / 2} - source), r = length(chord);
    double launch = guess.value_or(angle_of(chord));
    constexpr int most_turns = 20;
    constexpr double largest_turn = 0.3;
    for (int turn = 0; turn < most_turns; ++turn) {
      const auto end = followed(source, direction(launch), true,
                                [&](const BentRay& ray) { return dot(x - ray.x, ray.v); });
      if (!end) return std::nullopt;
      const RayTube& tube = end->tube;
      const double n = length(tube.v);
      const Vec across = 1 / n * Vec{tube.v.z, -tube.v.x};
      const double miss = dot(x - tube.x, across);
      if (std::abs(miss) < 1e-10 * r)
        return WaveTable::Node{
            {1 / n * tube.v, tube.path, 1 / std::sqrt(tube.spread()), end->inside,
             middle + std::remainder(launch - middle, 2 * std::numbers::pi)},
            n};
      launch += std::clamp(miss * n / tube.spread(), -largest_turn, largest_turn);
    }
    return std::nullopt;
  }

 private:
  std::shared_ptr<const Wavefront> wave_from_point(Vec source) const override {
    const double away = distance_to(domain_, source);
    const double spacing = std::min(spacing_, away / 6);
    if (away < 2 * spacing_ || away < 0.5)
      return std::make_shared<SearchedWave<Field>>(*this, source);
    return std::make_shared<WaveTable>(
        domain_, spacing, true,
        [&](Vec x, const WaveTable::Node* guess) {
          return arrival(source, x, guess ? std::optional(guess->arrival.launch) : std::nullopt);
        },
        std::string("(").append(number_text(source.x)) + ", " + number_text(source.z) + ")");
  }

  std::shared_ptr<const Wavefront> wave_from_afar(double angle) const override {
    return std::make_shared<WaveTable>(
        domain_, spacing_, false,
        [&](Vec x, const WaveTable::Node* guess) { return plane_arrival(angle, x, guess); },
        "direction " + number_text(angle));
  }

  Bend bend(Vec x) const {
    const auto [excess, gradient] = field_.gradient(in_space(x));
    const double n = 1 + excess;
    return {n * n, {n * gradient[0], n * gradient[2]}};
  }

  BendDerivatives bend_derivatives(Vec x) const {
    const auto [excess, g, h] = field_.hessian(in_space(x));
    const double n = 1 + excess;
    return {{n * n, {n * g[0], n * g[2]}},
            g[0] * g[0] + n * h(0, 0),
            g[0] * g[2] + n * h(0, 2),
            g[2] * g[2] + n * h(2, 2)};
  }

  BentRay begun(Vec x, Vec w) const { return {x, std::sqrt(std::max(square(x), 0.0)) * w}; }
  bool in_window(Vec x) const {
    return x.x >= low_.x && x.x <= high_.x && x.z >= low_.z && x.z <= high_.z;
  }
  /// Returns the parts in the domain of an integration step, in which the ray is approximated by a
  /// parabola.
  BentChords chords(const BentRay& from, const BentRay& to, double h) const {
    return {domain_, from.x, from.v, 2 / (h * h) * (to.x - from.x - h * from.v), h};
  }

  struct TubeEnd {
    RayTube tube;
    double inside;
  };
  /// Follows the ray from x along w until left(ray), which is positive up to there, becomes 0.
  /// Returns nullopt if the ray leaves the window or, if to_caustic is true, reaches a caustic
  /// first.
  template <typename Left>
  std::optional<TubeEnd> followed(Vec x, Vec w, bool to_caustic, const Left& left) const {
    const auto bend_at = [this](Vec place) { return bend_derivatives(place); };
    TubeEnd end{RayTube::from(x, begun(x, w).v), 0};
    double before = left(end.tube);
    if (!(before > 0)) return end;
    for (int step = 0; step < most_steps && in_window(end.tube.x); ++step) {
      RayTube next = stepped(end.tube, step_, bend_at);
      double h = step_, after = left(next);
      if (after <= 0) {  // false position, with a bisection in every third step
        double low = 0, high = h, at_low = before, at_high = after;
        for (int turn = 0; turn < 60 && std::abs(after) > 1e-13 * (1 + before); ++turn) {
          h = turn % 3 == 2 ? (low + high) / 2 : low + (high - low) * at_low / (at_low - at_high);
          next = stepped(end.tube, h, bend_at);
          after = left(next);
          (after > 0 ? low : high) = h;
          (after > 0 ? at_low : at_high) = after;
        }
        before = 0;
      } else {
        before = after;
      }
      if (to_caustic && !(next.spread() > 0)) return std::nullopt;
      if (h > 0) end.inside += chords(end.tube, next, h).length();
      end.tube = next;
      if (before == 0) return end;
    }
    return std::nullopt;
  }

  /// Finds the arrival of a plane wave at x, by the ray from x back to the entry face. If x lies in
  /// front of the face, the ray is followed forward to the face.
  std::optional<WaveTable::Node> plane_arrival(double angle, Vec x,
                                               const WaveTable::Node* guess) const {
    const double sine = std::sin(angle), cosine = std::cos(angle),
                 face = cosine > 0 ? 0 : domain_.depth, deep = (x.z - face) * cosine;
    const double sign =
        deep >= 0 ? -1 : 1;  // 1: the ray is followed along the light; -1: against it
    const double n2 = square(x);
    Vec w = guess ? guess->arrival.w
                  : Vec{sine, std::copysign(std::sqrt(std::max(n2 - sine * sine, 1e-4)), cosine)};
    double turned = angle_of(sign * w);
    constexpr int most_turns = 20;
    constexpr double largest_turn = 0.3;
    for (int turn = 0; turn < most_turns; ++turn) {
      const auto end = followed(x, direction(turned), false, [&](const BentRay& ray) {
        return (ray.x.z - face) * cosine * -sign;
      });
      if (!end) return std::nullopt;
      const RayTube& tube = end->tube;
      const double miss = tube.v.x - sign * sine,
                   derivative = tube.w.x - bend(tube.x).force.x / tube.v.z * tube.y.z;
      if (!(derivative * tube.v.z > 0)) return std::nullopt;
      if (std::abs(miss) < 1e-11)
        return WaveTable::Node{
            {sign * direction(turned), sine * tube.x.x + cosine * face - sign * tube.path,
             std::sqrt(std::abs(cosine / derivative)), sign < 0 ? end->inside : 0, tube.x.x},
            std::sqrt(n2)};
      turned -= std::clamp(miss / derivative, -largest_turn, largest_turn);
    }
    return std::nullopt;
  }

  Domain domain_;
  Field field_;
  double step_, spacing_;
  Vec low_, high_;  ///< opposite corners of the window in which rays are followed
};

template <class Field>
std::shared_ptr<const GradedMedium> in_steps(const Scene& scene, Field field) {
  return std::make_shared<const SteppedMedium<Field>>(scene, std::move(field));
}

grin::GaussianBlobs blobs_of(const IndexField& field) {
  std::vector<grin::GaussianBlob> blobs;
  for (const IndexBlob& blob : field.blobs)
    blobs.push_back({{blob.centre.x, 0, blob.centre.z}, blob.height, blob.width});
  return grin::GaussianBlobs(std::move(blobs), field.origin - 1);
}

grin::StandingWave sound_of(const Scene& scene) {
  // Largest argument k r of the Bessel function in the table of the standing wave; beyond the
  // table, evaluation is slow but correct
  constexpr double longest_table = 1e3;
  const IndexField& field = *scene.index;
  const double reach = 4 * (scene.domain.width + scene.domain.depth);
  return {field.origin - 1, field.sound_amplitude, 0, field.sound_wavenumber,
          std::min(reach, longest_table / field.sound_wavenumber)};
}

}  // namespace

std::shared_ptr<const GradedMedium> stepped_medium(const Scene& scene) {
  const IndexField& field = *scene.index;
  if (field.kind == IndexField::Kind::parabolic)
    return in_steps(scene,
                    grin::ParabolicGuide({field.origin - 1, field.alpha}, grin::Vec3(0, 0, 0)));
  if (field.kind == IndexField::Kind::blobs) return in_steps(scene, blobs_of(field));
  if (field.kind == IndexField::Kind::ultrasound) return in_steps(scene, sound_of(scene));
  return in_steps(scene, grin::read_spline_field(field.grid));
}

}  // namespace flatspeckle::mc
