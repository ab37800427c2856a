#include "grin/render/sensors/sensor_edges.h"

#include <numbers>
#include <string>

#include "grin/media/geometry/frame.h"

namespace flatspeckle::grin {

namespace {

[[noreturn]] void refuse(const std::string& why) {
  throw InputError("gradient_by: " + why);
}

/// Returns the smallest distance between a sensor and the edges of its face. reach: half extent of
/// the sensor along each axis.
double space_beside(const Box& stage, const Vec3& centre, const Vec3& outwards, const Vec3& reach) {
  double margin = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis)
    if (std::abs(outwards[axis]) < 0.5)
      margin = std::min({margin, centre[axis] - reach[axis] - stage.low[axis],
                         stage.high[axis] - centre[axis] - reach[axis]});
  return margin;
}

PixelLine::Edge edge(double at, double size, double margin) {
  constexpr double least = 0.125, most = 4;  // in units of the size
  if (!(margin >= least * size))
    refuse("sensors must keep a distance of a sixteenth of their width from edges of the stage");
  return {at, size, std::min(margin, most * size)};
}

PixelLine even_line(double half, int count, double margin) {
  std::vector<PixelLine::Edge> edges;
  for (int i = 0; i <= count; ++i)
    edges.push_back(edge(half * (2.0 * i / count - 1), half, margin));
  return PixelLine(edges);
}

void require_all_directions(double acceptance) {
  if (acceptance < std::numbers::pi / 2)
    refuse("sensors must accept light from all directions: leave out acceptance");
}

}  // namespace

int PixelLine::pixel_at(double coordinate) const {
  if (!(coordinate >= edges_.front().at && coordinate <= edges_.back().at)) return -1;
  const auto inner = std::span(edges_).subspan(1, edges_.size() - 2);
  return static_cast<int>(std::ranges::lower_bound(inner, coordinate, {}, &Edge::at) -
                          inner.begin());
}

SensorEdges::SensorEdges(const Sensor& sensor, const Box& stage, int first_pixel)
    : near_(1e-6 * (stage.high - stage.low).norm()), first_pixel_(first_pixel) {
  if (const auto* radial = std::get_if<RadialDetector>(&sensor))
    set(*radial, stage);
  else if (const auto* area = std::get_if<AreaDetector>(&sensor))
    set(*area, stage);
  else
    refuse("sensors must be radial or area");
}

void SensorEdges::set(const RadialDetector& detector, const Box& stage) {
  require_all_directions(detector.acceptance);
  centre_ = detector.centre;
  outwards_ = stage.normal(centre_);
  const Frame across = frame_across(outwards_);
  right_ = across.col(0);
  down_ = across.col(1);
  is_round_ = true;
  const double margin = space_beside(stage, centre_, outwards_, Vec3::Constant(detector.radius));
  const PixelRings rings = picture_of(detector);
  std::vector<PixelLine::Edge> edges{{0, 0, 0}};
  for (int ring = 0; ring < detector.rings; ++ring) {
    areas_.push_back(rings.area(ring));
    const double radius = rings.edge(ring + 1);
    edges.push_back(edge(radius, radius, margin));
  }
  columns_ = PixelLine(edges);
  rows_ = PixelLine({{-1, 0, 0}, {1, 0, 0}});
}

void SensorEdges::set(const AreaDetector& detector, const Box& stage) {
  require_all_directions(detector.acceptance);
  centre_ = detector.centre;
  outwards_ = stage.normal(centre_);
  const Orientation view("sensor_at", outwards_, detector.up);
  right_ = view.right;
  down_ = -view.up;
  const PixelRectangle face = picture_of(detector);
  const Vec3 reach = face.half_width() * right_.cwiseAbs() + face.half_height() * down_.cwiseAbs();
  const double margin = space_beside(stage, centre_, outwards_, reach);
  columns_ = even_line(face.half_width(), face.grid().columns, margin);
  rows_ = even_line(face.half_height(), face.grid().rows, margin);
  areas_.assign(static_cast<std::size_t>(face.grid().count()), face.pixel_area());
}

bool SensorEdges::is_near(const Vec3& x) const {
  if (!is_on_face(x)) return false;
  const auto [u, v] = coordinates(x);
  return columns_.is_near(u) && rows_.is_near(v);
}

}  // namespace flatspeckle::grin
