#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "grin/render/sensors/sensor.h"

namespace flatspeckle::grin {

/// How wide edges of pixels are taken to be where light moves over them. All widths at once: their
/// differences tell what a width does.
inline constexpr int edge_widths = 6;

/// On (-1, 1), of integral 1 and without a second moment: it changes a smooth density by the fourth
/// power of its width (Gasser, Mueller and Mammitzsch 1985, kernels for nonparametric curve
/// estimation).
inline double edge_kernel(double u) {
  const double square = u * u;
  return square < 1 ? 15.0 / 32 * (1 - square) * (3 - 7 * square) : 0;
}

/// Pixels side by side along a coordinate, and the edges between them.
class PixelLine {
 public:
  struct Edge {
    double at;
    double size;  ///< of what it bounds; 0: it is none
    double room;  ///< in which light is seen that moves over it, on either side
  };
  PixelLine() = default;
  explicit PixelLine(std::vector<Edge> edges) : edges_(std::move(edges)) {}

  std::span<const Edge> edges() const { return edges_; }
  int count() const { return static_cast<int>(edges_.size()) - 1; }
  /// -1 outside.
  int pixel_at(double coordinate) const;
  bool is_near(double coordinate) const {
    return coordinate > edges_.front().at - edges_.front().room &&
           coordinate < edges_.back().at + edges_.back().room;
  }

 private:
  std::vector<Edge> edges_;
};

/// Half the width that an edge has for what moves with such a speed by a whole of the parameter:
/// less than what may be seen on its way, more for what goes far.
inline double edge_width(const PixelLine::Edge& edge, double speed, int number) {
  constexpr double far = 0.2, most = 4;
  const double reach = std::clamp(far * speed, edge.size, most * edge.size);
  return std::min(std::ldexp(reach, -number), edge.room);
}

/// The pixels of a sensor on a face of a box, and what they gain from light that moves on it.
class SensorEdges {
 public:
  /// Throws InputError for sensors other than disks, rings and rectangles of all directions, and
  /// for those without room beside them on their face.
  SensorEdges(const Sensor& sensor, const Box& stage, int first_pixel);

  /// Of light on the boundary: whether it is on the sensor, or near an edge.
  bool is_near(const Vec3& x) const;
  /// use(pixel, area of the pixel), of the one that has x.
  template <class Use>
  void at(const Vec3& x, const Use& use) const {
    const auto [u, v] = coordinates(x);
    const int column = columns_.pixel_at(u), row = rows_.pixel_at(v);
    if (column < 0 || row < 0) return;
    const int pixel = row * columns_.count() + column;
    use(first_pixel_ + pixel, 1 / area(pixel));
  }
  /// Of light on its face: each edge by its number, where light passes it.
  bool is_on_face(const Vec3& x) const { return std::abs((x - centre_).dot(outwards_)) <= near_; }
  int edges() const { return columns_.count() + rows_.count() + 2; }  ///< those of size 0 are none
  const PixelLine::Edge& edge_at(int edge) const {
    return (is_column(edge) ? columns_ : rows_).edges()[static_cast<std::size_t>(on_line(edge))];
  }
  /// Towards larger radius, column or row.
  double beyond(int edge, const Vec3& x) const {
    const auto [u, v] = coordinates(x);
    return is_column(edge) ? u - edge_at(edge).at : v - edge_at(edge).at;
  }
  /// Its change as x moves.
  double speed(int edge, const Vec3& x, const Vec3& motion) const {
    const auto at = plane(x - centre_), by = plane(motion);
    if (is_round_) return (at.u * by.u + at.v * by.v) / std::hypot(at.u, at.v);
    return is_column(edge) ? by.u : by.v;
  }
  /// use(pixel, share of light that passes the edge there towards larger ones, per area of the
  /// pixel).
  template <class Use>
  void pass(int edge, const Vec3& x, const Use& use) const {
    const auto [u, v] = coordinates(x);
    const int row = rows_.pixel_at(v), column = columns_.pixel_at(u);
    for (const int side : {-1, 0}) {
      const int beside = on_line(edge) + side;
      const int of = is_column(edge) ? pixel(row, beside) : pixel(beside, column);
      if (of >= 0) use(first_pixel_ + of, (side < 0 ? -1 : 1) / area(of));
    }
  }
  /// Of light at x that a unit of a parameter moves so, a whole of which is `scale`: use(pixel,
  /// width, share of it that moves into the pixel, per area of that).
  template <class Use>
  void moved(const Vec3& x, const Vec3& motion, double scale, const Use& use) const {
    const auto at = plane(x - centre_), by = plane(motion);
    const double speed = std::hypot(by.u, by.v);
    if (!(speed > 0)) return;
    const Plane along{by.u / speed, by.v / speed};
    const auto cross = [&](const PixelLine::Edge& edge, double way, const Crossing& over) {
      for (int width = 0; width < edge_widths; ++width) {
        const double reach = edge_width(edge, speed * scale, width);
        const double flux = edge_kernel(way / reach) / reach * speed;
        if (flux == 0) continue;
        if (over.from >= 0) use(first_pixel_ + over.from, width, -flux / area(over.from));
        if (over.to >= 0) use(first_pixel_ + over.to, width, flux / area(over.to));
      }
    };
    is_round_ ? cross_rings(at, along, cross) : cross_lines(at, along, cross);
  }

 private:
  bool is_column(int edge) const { return edge <= columns_.count(); }
  /// Its number among those of columns, or of rows.
  int on_line(int edge) const { return is_column(edge) ? edge : edge - columns_.count() - 1; }
  struct Plane {
    double u, v;
  };
  struct Crossing {
    int from, to;  ///< pixels; -1: none
  };
  Plane plane(const Vec3& off) const { return {off.dot(right_), off.dot(down_)}; }
  double area(int pixel) const { return areas_[static_cast<std::size_t>(pixel)]; }
  int pixel(int row, int column) const {
    const bool is_one = row >= 0 && row < rows_.count() && column >= 0 && column < columns_.count();
    return is_one ? row * columns_.count() + column : -1;
  }
  Crossing crossing(int below, int above, bool is_up) const {
    return is_up ? Crossing{below, above} : Crossing{above, below};
  }
  /// use(edge, way to it, crossing), of those on the line through a point along a direction.
  template <class Use>
  void cross_rings(const Plane& at, const Plane& along, const Use& use) const {
    const double middle = -(at.u * along.u + at.v * along.v);
    const double aside = at.u * along.v - at.v * along.u;
    for (int ring = 1; ring <= columns_.count(); ++ring) {
      const PixelLine::Edge& edge = columns_.edges()[static_cast<std::size_t>(ring)];
      const double square = edge.at * edge.at - aside * aside;
      if (!(square > 0)) continue;
      const int beyond = ring < columns_.count() ? ring : -1;
      use(edge, middle - std::sqrt(square), Crossing{beyond, ring - 1});
      use(edge, middle + std::sqrt(square), Crossing{ring - 1, beyond});
    }
  }
  template <class Use>
  void cross_lines(const Plane& at, const Plane& along, const Use& use) const {
    for (int i = 0; along.u != 0 && i <= columns_.count(); ++i) {
      const PixelLine::Edge& edge = columns_.edges()[static_cast<std::size_t>(i)];
      const double way = (edge.at - at.u) / along.u;
      const int row = rows_.pixel_at(at.v + way * along.v);
      use(edge, way, crossing(pixel(row, i - 1), pixel(row, i), along.u > 0));
    }
    for (int i = 0; along.v != 0 && i <= rows_.count(); ++i) {
      const PixelLine::Edge& edge = rows_.edges()[static_cast<std::size_t>(i)];
      const double way = (edge.at - at.v) / along.v;
      const int column = columns_.pixel_at(at.u + way * along.u);
      use(edge, way, crossing(pixel(i - 1, column), pixel(i, column), along.v > 0));
    }
  }
  /// Along columns and rows.
  Plane coordinates(const Vec3& x) const {
    const Plane at = plane(x - centre_);
    return is_round_ ? Plane{std::hypot(at.u, at.v), 0} : at;
  }
  void set(const RadialDetector& detector, const Box& stage);
  void set(const AreaDetector& detector, const Box& stage);

  Vec3 centre_ = Vec3::Zero(), outwards_ = Vec3::Zero();
  Vec3 right_ = Vec3::Zero(), down_ = Vec3::Zero();
  bool is_round_ = false;
  PixelLine columns_, rows_;  ///< of disks: rings, and one without edges
  std::vector<double> areas_;
  double near_ = 0;
  int first_pixel_;
};

}  // namespace flatspeckle::grin
