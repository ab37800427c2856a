#include "grin/render/transport/depth_importance.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "grin/media/scattering/diffusion_rate.h"

namespace flatspeckle::grin {

namespace {

using std::numbers::pi;

constexpr double largest_log = 600;  // exp(largest_log) is finite in double precision
constexpr double thick = 8;  // optical depth from which connections to a sensor are thinned out

bool is_in_closed_form(const Surface& surface) {
  return std::holds_alternative<Box>(surface) || std::holds_alternative<Sphere>(surface);
}

/// Returns the decay rate of diffuse light along a direction in a box that is due to leakage
/// through the sides of the box.
double leak_rate(const ScatteringMedium& medium, double density, const Surface& within,
                 const Vec3& direction) {
  const auto* box = std::get_if<Box>(&within);
  if (!box || !(medium.mu_s > 0)) return 0;
  // Milne's extrapolation length, in transport mean free paths
  constexpr double extrapolation = 0.7104;
  const double transport =
      1 / (density * (medium.mu_t() - medium.mu_s * medium.phase.mean_cosine()));
  double square = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double width = box->high[axis] - box->low[axis] + 2 * extrapolation * transport;
    square += (1 - direction[axis] * direction[axis]) * pi * pi / (width * width);
  }
  return std::sqrt(square);
}

double diffuse_rate(const ScatteringMedium& medium, double density) {
  if (!(medium.mu_s > 0)) return density * medium.mu_a;
  const double g = medium.phase.mean_cosine();
  return density * medium.mu_t() * diffusion_rate(medium.albedo(), g, 3);
}

/// Fraction of the connections to a sensor that are worth their cost; below 1 only for an area
/// detector. Close to a large detector, hits are more effective: scattered paths sample its
/// directions uniformly, whereas connections sample positions uniformly over the window that
/// accepts light, few of which are close.
double connected_fraction(const Sensor& sensor, double extinction) {
  const auto* detector = std::get_if<AreaDetector>(&sensor);
  if (!detector) return 1;
  const double reach = std::tan(std::min(detector->acceptance, 1.57)) / extinction;
  const double area = std::min(detector->width * detector->height, pi * reach * reach);
  return std::min(1.0, 4 * pi / (extinction * extinction * area));
}

/// Deterministic sample of positions where light starts.
std::vector<PathPoint> starts_of(const StageLights& lights) {
  constexpr int count = 64;
  struct {
    double index(const PathPoint&) const { return 1; }
  } space;
  RandomStream random(0, static_cast<std::uint64_t>(Stream::render), ~std::uint64_t{2});
  std::vector<PathPoint> starts;
  for (int i = 0; i < count; ++i) starts.push_back(lights.sample_position(space, random).point);
  return starts;
}

}  // namespace

std::optional<DepthImportance> DepthImportance::of(const Stage& stage, const StageLights& lights,
                                                   const std::vector<Sensor>& sensors) {
  if (!is_in_closed_form(stage.boundary)) return std::nullopt;
  if (stage.bodies.size() > 1 || stage.has_opaque_bodies()) return std::nullopt;
  if (stage.parts() > 1 && !is_in_closed_form(stage.surface(1))) return std::nullopt;
  DepthImportance found(stage, lights, sensors);
  if (!found.is_thick_ && !found.control_variates_) return std::nullopt;
  return found;
}

DepthImportance::DepthImportance(const Stage& stage, const StageLights& lights,
                                 const std::vector<Sensor>& sensors)
    : boundary_(stage.boundary) {
  if (stage.parts() > 1) body_ = stage.surface(1);
  for (Part part = around; part < stage.parts(); ++part)
    extinction_[part] = mean_density(stage, part) * stage.medium_in(part).mu_t();
  const std::vector<PathPoint> starts = starts_of(lights);
  for (const Sensor& sensor : sensors) {
    Destination to{.nearest = std::visit(
                       [&](const auto& kind) { return nearest_place(kind, boundary_); }, sensor)};
    const Vec3 direction = path_to(starts[0], to).direction;
    to.decay = decay(stage, direction);
    find_shares(to, starts);
    if (!body_) to.connected = connected_fraction(sensor, extinction_[0]);
    most_connections_ = std::max(most_connections_, to.connected);
    const auto* camera = std::get_if<Camera>(&sensor);
    if (camera && camera->lens_radius == 0) inner_.push_back(camera->x);
    destinations_.push_back(to);
  }
  control_variates_ = ControlVariates::of(stage, direction_to_farthest(starts[0]), starts);
  if (control_variates_ && !pays(*control_variates_)) control_variates_.reset();
  if (is_thick_) return;
  // connections are thinned out in thick media alone
  for (Destination& to : destinations_) to.connected = 1;
  most_connections_ = 1;
}

DepthImportance::ByPart DepthImportance::decay(const Stage& stage, const Vec3& direction) const {
  ByPart found = {};
  for (Part part = around; part < stage.parts(); ++part) {
    const ScatteringMedium& medium = stage.medium_in(part);
    const double density = mean_density(stage, part);
    found[part] = std::hypot(diffuse_rate(medium, density),
                             leak_rate(medium, density, stage.surface(part), direction));
  }
  return found;
}

/// Sets is_deep and log_share of a sensor, for that start of light from which the optical depth to
/// the sensor is least.
void DepthImportance::find_shares(Destination& to, const std::vector<PathPoint>& starts) {
  constexpr double least_deep = 2;
  double depth = no_crossing, direct = no_crossing;
  for (const PathPoint& start : starts) {
    const StraightPath path = path_to(start, to);
    depth = std::min(depth, path.along(to.decay));
    direct = std::min(direct, path.along(extinction_));
  }
  to.is_deep = depth > least_deep;
  to.log_share = depth - std::log(std::max(3.0, depth / 4));
  favours_deep_ |= to.is_deep;
  is_thick_ |= direct > thick;
}

/// Whether control variates are worth their cost, and paths sample them well.
bool DepthImportance::pays(const ControlVariates& variates) const {
  return variates.depth() > thick && (favours_deep_ || variates.grows_little());
}

/// Returns the direction from `start` to the most distant sensor; 0 if `start` is on all sensors.
Vec3 DepthImportance::direction_to_farthest(const PathPoint& start) const {
  double farthest = 0;
  Vec3 direction = Vec3::Zero();
  for (const Destination& to : destinations_) {
    const StraightPath path = path_to(start, to);
    const double length = path.length[0] + path.length[1];
    if (length <= farthest) continue;
    farthest = length;
    direction = path.direction;
  }
  return direction;
}

DepthImportance::StraightPath DepthImportance::path_to(const PathPoint& p,
                                                       const Destination& to) const {
  const Vec3 chord = to.nearest(p.x) - p.x;
  const double length = chord.norm();
  if (!(length > 0)) return {Vec3::Zero()};
  StraightPath found{chord / length, {length, 0}};
  if (!body_) return found;
  const bool inside = p.part != around;
  const double in = inside ? 0 : std::min(length, entry_distance(*body_, p.x, found.direction));
  const double within = exit_distance(*body_, p.x + in * found.direction, found.direction);
  found.length[1] = std::min(length - in, within);
  found.length[0] = length - found.length[1];
  return found;
}

DepthImportance::ImportanceAndGradient DepthImportance::importance_and_gradient(
    const PathPoint& p) const {
  double most = -largest_log;
  Vec3 log_gradient = Vec3::Zero();
  if (!favours_deep_) return {1, log_gradient};
  for (const Destination& to : destinations_) {
    if (!to.is_deep) continue;
    const StraightPath path = path_to(p, to);
    const double log_importance = to.log_share - path.along(to.decay);
    if (log_importance < most) continue;
    most = log_importance;
    log_gradient = to.decay[p.part] * path.direction;
  }
  return {most > 0 ? std::exp(std::min(most, largest_log)) : 1, log_gradient};
}

double DepthImportance::clearance(const PathPoint& p) const {
  if (p.part != around) return -distance(*body_, p.x);
  if (body_) return 0;
  double least = -distance(boundary_, p.x);
  for (const Vec3& sensor : inner_) least = std::min(least, (sensor - p.x).norm());
  return least;
}

double DepthImportance::connection_probability(const PathPoint& p) const {
  if (!is_thick_) return 1;
  const double depth = extinction_[p.part] * clearance(p);
  const double beyond = 1 + std::max(0.0, depth / 2 - 1) / 8;
  const double square = beyond * beyond, fourth = square * square;
  return 1 / (fourth * fourth);
}

}  // namespace flatspeckle::grin
