#include "grin/render/methods/tracer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>

#include "grin/media/scattering/labelled_media.h"
#include "grin/render/methods/forward_light.h"
#include "grin/render/methods/path_kernels.h"
#include "grin/render/methods/pilot.h"
#include "grin/render/transport/subpath.h"

namespace flatspeckle::grin {

namespace {

/// Tally of a light path whose segments are added to a map.
template <class Cells>
class MapTally : public LightTally {
 public:
  MapTally(const Cells& cells, const Transport& transport, std::span<Complex> sums,
           EnergyBalance& energy, TransportCounts& counts)
      : LightTally(energy),
        cells_(cells),
        transport_(transport),
        sums_(sums),
        of_labels_(sums.last(label_count(transport.stage))),
        counts_(counts) {}

  Flight fly(const Space& space, const PathVertex& from, const Vec3& direction,
             RandomStream& random, const Vec3* log_gradient, FlightLog*) {
    log_.clear();
    const Flight flight = space.fly(from.point, direction, random, &log_, log_gradient);
    const double weight = from.weight * flight.bias_weight;
    for (const FlightSegment& segment : log_) {
      const ScatteringMedium& medium = transport_.medium(segment.start.part);
      const double apart = std::max(cells_.spacing(), segment.length / most_points);
      space.for_points(segment, apart, random,
                       [&](const Vec3& x, double length) { add(x, weight * length, medium); });
    }
    return flight;
  }

 private:
  static constexpr double most_points = 256;

  void add(const Vec3& x, double power_length, const ScatteringMedium& medium) {
    const int cell = cells_.cell_at(x);
    if (cell < 0) return;
    if (!std::isfinite(power_length)) {
      ++counts_.lost_values;
      return;
    }
    Complex* const sums = &sums_[sums_per_cell * static_cast<std::size_t>(cell)];
    const double absorbed = power_length * medium.absorption(x);
    sums[0] += power_length;
    sums[1] += absorbed;
    if (medium.labels)
      of_labels_[static_cast<std::size_t>(medium.labels->volume().at(x))] += absorbed;
  }

  const Cells& cells_;
  const Transport& transport_;
  std::span<Complex> sums_, of_labels_;
  TransportCounts& counts_;
  FlightLog log_;
};

template <class Tally>
void walk_light(const Transport& transport, const Space& space, RandomStream& random, Tally& tally,
                TransportCounts& counts) {
  UnsplitPath alone;
  const EndPosition end = transport.lights.sample_position(space, random);
  const PathVertex start = end_vertex(transport.strategies, end);
  const EndDirection first = transport.lights.sample_direction(end, random);
  walk(
      transport, space, never_chosen, start, first, false, random, counts, alone, tally,
      [](const PathVertex&) {}, [](const PathVertex&, const PathVertex&) {});
  tally.end_path();
}

// first batch number of the pilot run that aims lights; those of other pilot runs are above
constexpr std::uint64_t first_of_aim = std::uint64_t{1} << 63;

bool is_beam(const Light& light) {
  return std::holds_alternative<BeamLight>(light);
}

Strategies strategies(const RenderScene& scene, RenderMethod method) {
  const bool is_light = method == RenderMethod::light;
  const bool has_beam = std::any_of(scene.lights.begin(), scene.lights.end(), is_beam);
  return {.short_light = method == RenderMethod::path,
          .short_sensor = is_light,
          .connects_beams = has_beam && !is_light};
}

int path_limit(const RenderRequest& request) {
  constexpr int unlimited = std::numeric_limits<int>::max();
  if (request.max_scatterings <= 0) return unlimited;
  return static_cast<int>(std::min<std::int64_t>(request.max_scatterings, unlimited));
}

double index_at(const RenderScene& scene, const PathPoint& p) {
  if (p.part != scene.stage.field_part()) return 1 + scene.stage.excess_in(p.part);
  return std::visit([&](const auto& field) { return index(field, p.x); }, scene.field);
}

/// Returns the largest angle, in rad, between light guided by the index field and the axis of the
/// guide; it follows from the range of the index.
double bending_of(const RenderScene& scene) {
  return scene.index ? std::sqrt(2 * (scene.index->highest / scene.index->lowest - 1)) : 0;
}

/// Calls use(LabelVolume) for each medium of labelled voxels.
template <class Use>
void each_volume(const Stage& stage, const Use& use) {
  for (Part part = around; part < stage.parts(); ++part)
    if (const auto& labels = stage.medium_in(part).labels) use(labels->volume());
}

}  // namespace

std::size_t label_count(const Stage& stage) {
  std::size_t count = 0;
  each_volume(stage, [&](const LabelVolume& volume) {
    count = std::max(count, std::ranges::max(volume.labels) + std::size_t{1});
  });
  return count;
}

std::size_t map_sums(const LightMap& map, const Stage& stage) {
  return sums_per_cell * static_cast<std::size_t>(cells(map)) + label_count(stage);
}

MapKernel map_kernel(const LightMap& map, std::shared_ptr<const Transport> transport,
                     std::shared_ptr<const Space> space, bool random_phase) {
  return [=](int paths, RandomStream& random, std::span<Complex> sums, EnergyBalance& energy,
             TransportCounts& counts) {
    std::visit(
        [&](const auto& cells) {
          MapTally tally(cells, *transport, sums.first(map_sums(map, transport->stage)), energy,
                         counts);
          for (int path = 0; path < paths; ++path) {
            if (random_phase) {
              const auto met = space->frozen(2 * std::numbers::pi * random.uniform());
              walk_light(*transport, *met, random, tally, counts);
            } else {
              walk_light(*transport, *space, random, tally, counts);
            }
          }
          for (std::size_t i = 0; i < sums_per_cell * static_cast<std::size_t>(grin::cells(map));
               ++i)
            sums[i] /= cells.volume(static_cast<int>(i / sums_per_cell));
        },
        map);
  };
}

RenderPlan render_plan(const RenderScene& scene) {
  RenderPlan plan;
  plan.curved = !std::holds_alternative<Homogeneous>(scene.field);
  plan.body = !scene.stage.bodies.empty();
  plan.timed = scene.bins.keeps_paths();
  plan.scatters = plan.absorbs = plan.gridded = plan.deep = false;
  const auto add = [&](const ScatteringMedium& medium) {
    plan.scatters |= medium.mu_s > 0;
    plan.absorbs |= medium.mu_a > 0;
    plan.gridded |= !medium.is_uniform() && medium.mu_t() > 0;
  };
  add(scene.stage.medium);
  for (const Body& body : scene.stage.bodies) add(body.medium);
  return plan;
}

bool can_be_forward(const RenderScene& scene) {
  const auto ends = sensor_endpoints(scene.sensors, scene.stage);
  return std::all_of(ends.begin(), ends.end(),
                     [](const SensorEnd& end) { return end.can_be_hit(); });
}

std::shared_ptr<Transport> transport_of(const RenderScene& scene, const RenderRequest& request,
                                        RenderMethod method) {
  const auto index = [&](const PathPoint& p) { return index_at(scene, p); };
  return std::make_shared<Transport>(Transport{
      .stage = scene.stage,
      .lights = StageLights(scene.lights, scene.stage, index),
      .sensors = sensor_endpoints(scene.sensors, scene.stage),
      .strategies = strategies(scene, method),
      .max_scatterings = path_limit(request),
  });
}

void Tracer::add(int paths, RandomStream& random, Film& film, TransportCounts& counts) const {
  if (kernel) kernel(paths, random, film, counts, nullptr);
  if (!unscattered_beams) return;
  const double rays = std::ceil(rays_per_path * paths);
  unscattered_beams(static_cast<int>(rays), paths / rays, random, film, counts);
}

Tracers::Tracers(const RenderScene& scene, const RenderRequest& request)
    : scene_(scene), request_(request), plan_(render_plan(scene)) {
  if (!plan_.curved && plan_.scatters) find_depth();
  if (!scene.parameters.empty()) find_motion();
  if (scene.sensors.empty()) return;
  find_beams();
  const bool may_be_forward =
      request.method.value_or(RenderMethod::forward) == RenderMethod::forward;
  if (!walks_ || !may_be_forward || !can_be_forward(scene)) return;
  find_guide();
  if (!guide_) find_aim();
}

void Tracers::find_depth() {
  const auto transport = transport_of(scene_, request_, RenderMethod::light);
  const auto depth = DepthImportance::of(scene_.stage, transport->lights, scene_.sensors);
  if (depth) depth_ = std::make_shared<const DepthImportance>(*depth);
  plan_.deep = depth.has_value();
}

void Tracers::find_motion() {
  std::vector<SensorEdges> edges;
  int first_pixel = 0;
  for (const Sensor& sensor : scene_.sensors) {
    edges.emplace_back(sensor, std::get<Box>(scene_.stage.boundary), first_pixel);
    first_pixel += pixels_of(sensor).grid.count();
  }
  moving_ = std::make_shared<const MovingField>(MovingField::Scene{
      scene_.field, scene_.stage, options(Spreading::none), scene_.parameters, std::move(edges)});
}

/// Makes the kernel of unscattered beams once for all methods, since the search for connections to
/// beams may take longer than a pilot run.
void Tracers::find_beams() {
  const auto transport = transport_of(scene_, request_, RenderMethod::bidirectional);
  if (scene_.bins.sound || !(transport->lights.beam_power() > 0)) return;
  walks_ = plan_.scatters || !transport->lights.are_beams() || !are_followed(*transport);
  const std::shared_ptr<const Space> space =
      make_space(scene_.field, without_scattering(scene_.stage), options(Spreading::none));
  constexpr double most = 0.5;
  const bool is_forward = request_.method.value_or(RenderMethod::forward) == RenderMethod::forward;
  counts_rays_ = !walks_ && is_forward && (plan_.curved || request_.method) &&
                 can_be_forward(scene_) && fraction_that_hits(*transport, *space) > most;
  const BeamsRequest asked{scene_.random_phase, !walks_, !counts_rays_, moving_};
  unscattered_beams_ = beams_kernel(asked, transport, space);
  if (walks_ && plan_.curved) few_rays_per_path_ = rays_beside_path(transport->lights, *space);
}

void Tracers::find_guide() {
  if (auto guide = PathGuide::of(scene_)) guide_ = std::make_shared<const PathGuide>(*guide);
}

/// Aims the lights of counted paths at the sensors: zones of directions are sampled in proportion
/// to the root mean square of the light that reaches the sensors from them, by a pilot run, and at
/// least half as often as a neighbour. A quarter of the paths are not aimed, so that no path has a
/// high weight.
void Tracers::find_aim() {
  constexpr int paths = 64;  // in each zone
  constexpr double unaimed = 0.25, much = 2;
  const Tracer pilot = untuned(RenderMethod::forward);
  if (!pilot.transport->lights.aim(Aim::at_zone(0))) return;
  const int pixels = pilot.transport->pixels();
  std::vector<Complex> sums(static_cast<std::size_t>(pixels) * scene_.bins.sums());
  const std::vector<PixelShare> all(static_cast<std::size_t>(pixels), PixelShare{0, 1});
  Aim::Shares squares{}, aim{};
  for (std::size_t zone = 0; zone < Aim::zones; ++zone) {
    const double width = Aim::width(zone);
    pilot.transport->lights.aim(Aim::at_zone(zone));
    TransportCounts counts;
    for (int path = 0; path < paths; ++path) {
      Film film(pixels, scene_.bins, sums);
      film.shares = all;
      film.hits.resize(1);
      RandomStream random(0, static_cast<std::uint64_t>(Stream::render), first_of_aim + path);
      pilot.kernel(1, random, film, counts, nullptr);
      // in a zone alone, weights are less by its width
      squares[zone] += std::pow(film.hits[0] / width, 2) / paths;
    }
  }
  double root = 0, square = 0;  // means over unaimed directions
  for (std::size_t zone = 0; zone < Aim::zones; ++zone) {
    const double before = zone > 0 ? squares[zone - 1] : 0,
                 after = zone + 1 < Aim::zones ? squares[zone + 1] : 0;
    aim[zone] = Aim::width(zone) * std::sqrt(std::max({squares[zone], before / 4, after / 4}));
    root += aim[zone];
    square += Aim::width(zone) * squares[zone];
  }
  if (!(root > 0 && root * root * much < square)) return;
  for (std::size_t zone = 0; zone < Aim::zones; ++zone)
    aim[zone] = (1 - unaimed) * aim[zone] / root + unaimed * Aim::width(zone);
  aim_.emplace(aim);
}

Tracer Tracers::make(RenderMethod method) const {
  Tracer tracer = untuned(method);
  tracer.unscattered_beams = unscattered_beams_;
  if (method == RenderMethod::forward) tracer.rays_per_path = few_rays_per_path_;
  if (!walks_) {
    tracer.kernel = nullptr;
    return tracer;
  }
  tracer.flights_per_pair = flights(tracer);
  // rays of beams are cheap beside long paths
  constexpr double most_rays = 64, flights_per_ray = 64;
  if (!plan_.curved)
    tracer.rays_per_path = std::clamp(tracer.flights_per_pair / flights_per_ray, 1.0, most_rays);
  return tracer;
}

double Tracers::flights(const Tracer& tracer) const {
  const auto& [method, transport, kernel] =
      std::tie(tracer.method, tracer.transport, tracer.kernel);
  if (method == RenderMethod::forward) return flights_per_path(*transport, kernel, scene_.bins);
  return tune_connections(*transport, kernel, scene_.bins, tracer.flights_per_connection,
                          plan_.curved);
}

MapKernel Tracers::map_kernel() const {
  if (!scene_.map) return {};
  const auto transport = transport_of(scene_, request_, RenderMethod::light);
  const std::shared_ptr<const Space> space =
      make_space(scene_.field, scene_.stage, options(Spreading::none));
  return grin::map_kernel(*scene_.map, transport, space, scene_.random_phase);
}

double Tracers::cost_of_flight() const {
  const Box box = bounds(scene_.stage.boundary);
  const double diagonal = (box.high - box.low).norm();
  double tentative = 0;
  const auto add = [&](const ScatteringMedium& medium) {
    if (!medium.is_uniform()) tentative += medium.mu_t() * medium.largest_relative() * diagonal;
  };
  add(scene_.stage.medium);
  for (const Body& body : scene_.stage.bodies) add(body.medium);
  const double steps = plan_.curved ? diagonal / scene_.step : 0;
  return std::max(1.0, steps / 20) + tentative / 5;
}

double Tracers::steps_of_flight() const {
  const Box box = bounds(scene_.stage.boundary);
  const double across = (box.high - box.low).norm();
  return across / (1 + scene_.stage.medium.mu_s * across) / scene_.step;
}

SpaceOptions Tracers::options(Spreading spreading) const {
  return {scene_.step, scene_.max_length, spreading, scene_.leapfrogs};
}

/// Returns the flights of a method for which |J| is computed. Light tracing needs |J| only for the
/// last flight, which is then traced a second time; this pays off if there are many flights before
/// it.
Spreading Tracers::spreading_of(RenderMethod method) const {
  if (method == RenderMethod::forward) return Spreading::none;
  if (method != RenderMethod::light || !plan_.curved) return Spreading::all;
  constexpr double many = 6;  // scattering depth
  const Part part = scene_.stage.field_part();
  const Box box = bounds(scene_.stage.surface(part));
  const double depth = scene_.stage.medium_in(part).mu_s * (box.high - box.low).minCoeff();
  return depth > many ? Spreading::to_boundary : Spreading::all;
}

Tracer Tracers::untuned(RenderMethod method) const {
  const auto transport = transport_of(scene_, request_, method);
  if (!plan_.curved) transport->depth = depth_;
  const std::shared_ptr<const Space> space =
      make_space(scene_.field, scene_.stage, options(spreading_of(method)));
  if (method == RenderMethod::forward && guide_) {
    Tracer tracer{method, transport, guided_kernel(guide_, transport, space)};
    tracer.is_guided = true;
    return tracer;
  }
  if (method == RenderMethod::forward) {
    if (aim_) transport->lights.aim(*aim_);
    const auto target = SensorTarget::of(*transport, *space, bending_of(scene_));
    Tracer tracer{method, transport,
                  forward_kernel(transport, space, target, scene_.random_phase, moving_)};
    tracer.has_control_variates = forward_controls(*transport, target.has_value());
    tracer.is_aimed = aim_.has_value();
    return tracer;
  }
  Tracer tracer{method, transport, path_kernel(plan_, transport, space, scene_.random_phase)};
  tracer.has_control_variates =
      method != RenderMethod::path && transport->depth && transport->depth->control_variates();
  if (!plan_.curved) return tracer;
  tracer.flights_per_connection = space->cost_of_connection();
  tracer.cost_of_closed_connection = space->cost_of_closed_connection();
  tracer.spreading = spreading_of(method);
  return tracer;
}

}  // namespace flatspeckle::grin
