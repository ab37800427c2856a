#include "mc/paths/bent/stepped_medium.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/keys/number_text.h"
#include "grin/media/fields/gaussian_blobs.h"
#include "grin/media/fields/parabolic.h"
#include "grin/media/fields/spline_field.h"
#include "grin/media/fields/ultrasound.h"

namespace flatspeckle::mc {

namespace {

using Four = std::array<double, 4>;

/// Of values and slopes at 0 and 1 (Hermite): v0, v1, s0, s1.
Four hermite(double t) {
  const double u = 1 - t;
  return {u * u * (1 + 2 * t), t * t * (3 - 2 * t), t * u * u, -t * t * u};
}
Four hermite_slope(double t) {
  return {-6 * t * (1 - t), 6 * t * (1 - t), (1 - t) * (1 - 3 * t), t * (3 * t - 2)};
}
/// Of values at -1, 0, 1 and 2 (cubic convolution).
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

grin::Vec3 in_space(Vec2 x) {
  return {x.x, 0, x.z};
}

/// A point in the medium or near it: every ray anew.
template <class Field>
class SoughtWave : public Wavefront {
 public:
  SoughtWave(const SteppedMedium<Field>& medium, Vec2 source) : medium_(medium), source_(source) {}

  std::optional<Arrival> at(Vec2 x) const override {
    const auto node = medium_.arrival(source_, x, std::nullopt);
    if (!node) return std::nullopt;
    return node->arrival;
  }

 private:
  const SteppedMedium<Field>& medium_;
  Vec2 source_;
};

double distance_to(const Domain& box, Vec2 x) {
  return std::hypot(std::max(0.0, std::abs(x.x) - box.width / 2),
                    std::max({0.0, -x.z, x.z - box.depth}));
}

}  // namespace

WaveTable::WaveTable(const Domain& box, double spacing, bool spreads, const At& at,
                     const std::string& whose)
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
      const Vec2 x = origin_ + Vec2{static_cast<double>(i) * dx_, static_cast<double>(j) * dz_};
      const Node* guess = j > 0 ? &row[i] : i > 0 ? &row[i - 1] : nullptr;
      const auto node = at(x, guess);
      if (!node)
        throw InputError("index_field: light of " + whose + " does not come to (" +
                         number_text(x.x) + ", " + number_text(x.z) +
                         ") by one ray: a caustic is before it; take a weaker field, a smaller "
                         "box or other ends");
      row[i] = *node;
      const auto& [w, path, amplitude, inside, launch] = node->arrival;
      const double chord = box.contains(x) ? box.distance_to_edge(x, -w) : 0;
      entries_.push_back({path, node->index * w.x, node->index * w.z, 0,
                          std::log(spreads ? amplitude * std::sqrt(path) : amplitude),
                          chord > 1e-9 * dx_ ? inside / chord : 1 / node->index, launch});
    }
  find_mixed_derivatives();
}

/// By differences of by_x along z; at the outermost rows that of the next is as good.
void WaveTable::find_mixed_derivatives() {
  for (std::size_t j = 0; j < rows_; ++j)
    for (std::size_t i = 0; i < columns_; ++i) {
      const std::size_t middle = std::clamp<std::size_t>(j, 1, rows_ - 2);
      entries_[j * columns_ + i].by_both =
          (entry(i, middle + 1).by_x - entry(i, middle - 1).by_x) / (2 * dz_);
    }
}

std::optional<Arrival> WaveTable::at(Vec2 x) const {
  const double along = (x.x - origin_.x) / dx_, deep = (x.z - origin_.z) / dz_;
  const auto cell = [](double position, std::size_t size) {
    return static_cast<std::size_t>(std::clamp(position, 1.0, static_cast<double>(size - 3)));
  };
  const std::size_t i = cell(along, columns_), j = cell(deep, rows_);
  const double s = along - static_cast<double>(i), t = deep - static_cast<double>(j);
  const Four a = hermite(s), b = hermite(t), da = hermite_slope(s), db = hermite_slope(t),
             p = convolution(s), q = convolution(t);
  Arrival found{{}, 0, 0, 0, 0};
  Vec2 v{0, 0};
  for (std::size_t m = 0; m < 2; ++m)
    for (std::size_t n = 0; n < 2; ++n) {
      const Entry& e = entry(i + m, j + n);
      const double sx = dx_ * e.by_x, sz = dz_ * e.by_z, both = dx_ * dz_ * e.by_both;
      found.path +=
          a[m] * (b[n] * e.path + b[2 + n] * sz) + a[2 + m] * (b[n] * sx + b[2 + n] * both);
      v.x += (da[m] * (b[n] * e.path + b[2 + n] * sz) + da[2 + m] * (b[n] * sx + b[2 + n] * both)) /
             dx_;
      v.z +=
          (a[m] * (db[n] * e.path + db[2 + n] * sz) + a[2 + m] * (db[n] * sx + db[2 + n] * both)) /
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

template <class Field>
SteppedMedium<Field>::SteppedMedium(const Scene& scene, Field field, double scale)
    : domain_(scene.domain), field_(std::move(field)) {
  constexpr double step_per_scale = 0.25, spacing_per_scale = 0.25, step_per_box = 0.125;
  const double size = std::max(domain_.width, domain_.depth),
               least = std::min(domain_.width, domain_.depth);
  step_ = std::min(step_per_scale * scale, step_per_box * size);
  spacing_ = std::min(spacing_per_scale * scale, least / 8);
  low_ = {-domain_.width / 2, 0};
  high_ = {domain_.width / 2, domain_.depth};
  const auto take = [&](Vec2 x) {
    low_ = {std::min(low_.x, x.x), std::min(low_.z, x.z)};
    high_ = {std::max(high_.x, x.x), std::max(high_.z, x.z)};
  };
  for (const Light& light : scene.request.lights)
    if (light.kind == Light::Kind::point) take(light.point);
  for (const View& view : scene.request.views)
    if (view.near) take(view.point);
  low_ = low_ - Vec2{size, size};
  high_ = high_ + Vec2{size, size};
}

template <class Field>
Bend SteppedMedium<Field>::bend(Vec2 x) const {
  const auto [excess, gradient] = field_.gradient(in_space(x));
  const double n = 1 + excess;
  return {n * n, {n * gradient[0], n * gradient[2]}};
}

template <class Field>
BentBend SteppedMedium<Field>::bent_bend(Vec2 x) const {
  const auto [excess, g, h] = field_.hessian(in_space(x));
  const double n = 1 + excess;
  return {{n * n, {n * g[0], n * g[2]}},
          g[0] * g[0] + n * h(0, 0),
          g[0] * g[2] + n * h(0, 2),
          g[2] * g[2] + n * h(2, 2)};
}

template <class Field>
bool SteppedMedium<Field>::in_window(Vec2 x) const {
  return x.x >= low_.x && x.x <= high_.x && x.z >= low_.z && x.z <= high_.z;
}

template <class Field>
BentChords SteppedMedium<Field>::chords(const BentRay& from, const BentRay& to, double h) const {
  return {domain_, from.x, from.v, 2 / (h * h) * (to.x - from.x - h * from.v), h};
}

template <class Field>
double SteppedMedium<Field>::inside(Vec2 x, Vec2 w) const {
  BentRay ray = begun(x, w);
  double sum = 0;
  for (int step = 0; step < most_steps && in_window(ray.x); ++step) {
    const BentRay next = stepped(ray, step_, [this](Vec2 place) { return bend(place); });
    sum += chords(ray, next, step_).length();
    ray = next;
  }
  return sum;
}

template <class Field>
std::optional<RayPlace> SteppedMedium<Field>::flown(Vec2 x, Vec2 w, double sigma) const {
  const auto bend_at = [this](Vec2 place) { return bend(place); };
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

template <class Field>
template <typename Left>
auto SteppedMedium<Field>::followed(Vec2 x, Vec2 w, bool to_caustic, const Left& left) const
    -> std::optional<End> {
  const auto bend_at = [this](Vec2 place) { return bent_bend(place); };
  End end{RayTube::from(x, begun(x, w).v), 0};
  double before = left(end.tube);
  if (!(before > 0)) return end;
  for (int step = 0; step < most_steps && in_window(end.tube.x); ++step) {
    RayTube next = stepped(end.tube, step_, bend_at);
    double h = step_, after = left(next);
    if (after <= 0) {  // false position with bisection where it stalls
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

template <class Field>
std::optional<WaveTable::Node> SteppedMedium<Field>::arrival(Vec2 source, Vec2 x,
                                                             std::optional<double> guess) const {
  const Vec2 chord = x - source;
  const double middle = angle_of(Vec2{0, domain_.depth / 2} - source), r = length(chord);
  double launch = guess.value_or(angle_of(chord));
  constexpr int most_turns = 20;
  constexpr double largest_turn = 0.3;
  for (int turn = 0; turn < most_turns; ++turn) {
    const auto end = followed(source, direction(launch), true,
                              [&](const BentRay& ray) { return dot(x - ray.x, ray.v); });
    if (!end) return std::nullopt;
    const RayTube& tube = end->tube;
    const double n = length(tube.v);
    const Vec2 across = 1 / n * Vec2{tube.v.z, -tube.v.x};
    const double miss = dot(x - tube.x, across);
    if (std::abs(miss) < 1e-10 * r)
      return WaveTable::Node{{1 / n * tube.v, tube.path, 1 / std::sqrt(tube.spread()), end->inside,
                              middle + std::remainder(launch - middle, 2 * std::numbers::pi)},
                             n};
    launch += std::clamp(miss * n / tube.spread(), -largest_turn, largest_turn);
  }
  return std::nullopt;
}

/// By the ray from x to the face, against the light, or along it where x is before the face.
template <class Field>
std::optional<WaveTable::Node> SteppedMedium<Field>::plane_arrival(
    double angle, Vec2 x, const WaveTable::Node* guess) const {
  const double sine = std::sin(angle), cosine = std::cos(angle),
               face = cosine > 0 ? 0 : domain_.depth, deep = (x.z - face) * cosine;
  const double way = deep >= 0 ? -1 : 1;  // times the light's direction
  const double n2 = square(x);
  Vec2 w = guess ? guess->arrival.w
                 : Vec2{sine, std::copysign(std::sqrt(std::max(n2 - sine * sine, 1e-4)), cosine)};
  double turned = angle_of(way * w);
  constexpr int most_turns = 20;
  constexpr double largest_turn = 0.3;
  for (int turn = 0; turn < most_turns; ++turn) {
    const auto end = followed(x, direction(turned), false,
                              [&](const BentRay& ray) { return (ray.x.z - face) * cosine * -way; });
    if (!end) return std::nullopt;
    const RayTube& tube = end->tube;
    const double miss = tube.v.x - way * sine,
                 slope = tube.w.x - bend(tube.x).force.x / tube.v.z * tube.y.z;
    if (!(slope * tube.v.z > 0)) return std::nullopt;
    if (std::abs(miss) < 1e-11)
      return WaveTable::Node{
          {way * direction(turned), sine * tube.x.x + cosine * face - way * tube.path,
           std::sqrt(std::abs(cosine / slope)), way < 0 ? end->inside : 0, tube.x.x},
          std::sqrt(n2)};
    turned -= std::clamp(miss / slope, -largest_turn, largest_turn);
  }
  return std::nullopt;
}

template <class Field>
std::shared_ptr<const Wavefront> SteppedMedium<Field>::wave_from_point(Vec2 source) const {
  const double away = distance_to(domain_, source);
  const double spacing = std::min(spacing_, away / 6);
  if (away < 2 * spacing_ || away < 0.5) return std::make_shared<SoughtWave<Field>>(*this, source);
  return std::make_shared<WaveTable>(
      domain_, spacing, true,
      [&](Vec2 x, const WaveTable::Node* guess) {
        return arrival(source, x, guess ? std::optional(guess->arrival.launch) : std::nullopt);
      },
      std::string("(").append(number_text(source.x)) + ", " + number_text(source.z) + ")");
}

template <class Field>
std::shared_ptr<const Wavefront> SteppedMedium<Field>::wave_from_afar(double angle) const {
  return std::make_shared<WaveTable>(
      domain_, spacing_, false,
      [&](Vec2 x, const WaveTable::Node* guess) { return plane_arrival(angle, x, guess); },
      "direction " + number_text(angle));
}

template class SteppedMedium<grin::ParabolicGuide>;
template class SteppedMedium<grin::GaussianBlobs>;
template class SteppedMedium<grin::StandingWave>;
template class SteppedMedium<grin::SplineField>;

}  // namespace flatspeckle::mc
