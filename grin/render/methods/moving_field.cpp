#include "grin/render/methods/moving_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace flatspeckle::grin {

MovingField::MovingField(const Scene& scene)
    : field_(make_ray_field(scene.field, {}, scene.options.leapfrogs)),
      clear_(make_space(scene.field, without_scattering(scene.stage), scene.options)),
      stage_(std::get<Box>(scene.stage.boundary)),
      medium_(scene.stage.medium),
      step_(scene.options.step),
      edges_(scene.edges) {
  const auto rays_in = [&](const AnyIndexField& field) {
    return make_ray_field(field, {}, scene.options.leapfrogs);
  };
  for (const FieldParameter& of : scene.parameters)
    sides_.push_back({rays_in(of.less), rays_in(of.more), of.scale, of.step});
}

namespace {

// iterations that correct sigma, needed since the index changes along the ray
constexpr int corrections = 3;

int steps_of(double sigma, double step) {
  return std::max(1, static_cast<int>(std::ceil(sigma / step)));
}

/// Advances a group of rays whose remaining lengths are similar, in SIMD lanes.
void go_side_by_side(std::span<const std::size_t> some, std::span<const double> lengths,
                     const RayField& field, double step, std::span<RayState> rays) {
  RayLanes all{};
  const auto number = [&](int lane) {
    return some[std::min(static_cast<std::size_t>(lane), some.size() - 1)];
  };
  for (int lane = 0; lane < lanes; ++lane) all.put(lane, rays[number(lane)]);
  for (int again = 0; again <= corrections; ++again) {
    double furthest = 0;
    for (int lane = 0; lane < lanes; ++lane) {
      all.step[lane] = (lengths[number(lane)] - all.arc_length[lane]) / all.v.at(lane).norm();
      furthest = std::max(furthest, all.step[lane]);
    }
    const int steps = steps_of(furthest, step);
    for (double& of : all.step) of /= steps;
    field.advance_lanes(steps, all);
  }
  for (std::size_t lane = 0; lane < some.size(); ++lane)
    rays[some[lane]] = all.at(static_cast<int>(lane));
}

void go_side_by_side(std::span<const double> lengths, const RayField& field, double step,
                     std::span<RayState> rays) {
  std::vector<std::size_t> order(rays.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) { return lengths[i] - rays[i].arc_length; });
  for (std::size_t first = 0; first < order.size(); first += lanes)
    go_side_by_side(
        std::span(order).subspan(first, std::min<std::size_t>(lanes, order.size() - first)),
        lengths, field, step, rays);
}

/// Advances each ray to its arc length in `lengths`.
void go_to(std::span<const double> lengths, const RayField& field, double step,
           std::span<RayState> rays) {
  if (field.has_lanes()) return go_side_by_side(lengths, field, step, rays);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const double sigma = (lengths[i] - rays[i].arc_length) / rays[i].v.norm();
    field.advance(sigma, steps_of(sigma, step), rays[i], nullptr);
    for (int again = 0; again < corrections; ++again)
      field.advance((lengths[i] - rays[i].arc_length) / rays[i].v.norm(), 1, rays[i], nullptr);
  }
}

RayState start_ray(const RayField& field, const Vec3& x, const Vec3& direction) {
  return {x, (1 + field.excess(x)) * direction.normalized()};
}

}  // namespace

double MovingField::index_change(std::size_t parameter, const Vec3& x) const {
  const Sides& of = sides_[parameter];
  const double less = of.less->excess(x), more = of.more->excess(x);
  return (more - less) / (2 * of.step * (1 + (less + more) / 2));
}

std::vector<Flight> MovingField::flown(std::span<const Ray> starts) const {
  std::vector<Flight> found(starts.size());
  RandomStream none(0, 0, 0);
  if (!clear_->has_lanes()) {
    for (std::size_t i = 0; i < starts.size(); ++i)
      found[i] = clear_->fly({starts[i].x, around}, starts[i].direction, none);
    return found;
  }
  std::array<std::size_t, lanes> number{};
  std::size_t next = 0;
  clear_->fly_side_by_side(
      [&](int lane, const Flight* flight) -> std::optional<Space::FlightStart> {
        std::size_t& own = number[static_cast<std::size_t>(lane)];
        if (flight) found[own] = *flight;
        if (next == starts.size()) return std::nullopt;
        own = next++;
        return Space::FlightStart{{starts[own].x, around}, starts[own].direction, &none};
      });
  return found;
}

std::vector<std::vector<MovingField::Motion>> MovingField::moved(
    std::size_t parameter, std::span<const Ray> starts, std::span<const Motion> motions,
    std::span<const Lengths> stops) const {
  const Sides& of = sides_[parameter];
  std::vector<std::vector<Motion>> found(stops.size(), std::vector<Motion>(starts.size()));
  for (const double by : {-of.step, of.step}) {
    const RayField& field = by < 0 ? *of.less : *of.more;
    std::vector<RayState> rays;
    for (std::size_t k = 0; k < starts.size(); ++k)
      rays.push_back(start_ray(field, starts[k].x + by * motions[k].x,
                               starts[k].direction + by * motions[k].direction));
    for (std::size_t stop = 0; stop < stops.size(); ++stop) {
      go_to(stops[stop], field, step_, rays);
      for (std::size_t k = 0; k < rays.size(); ++k) {
        found[stop][k].x += rays[k].x / (2 * by);
        found[stop][k].direction += rays[k].v.normalized() / (2 * by);
      }
    }
  }
  return found;
}

}  // namespace flatspeckle::grin
