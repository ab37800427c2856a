#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "grin/render/sensors/sensor.h"

namespace flatspeckle::grin {

/// Number of smoothing widths. For derivatives of light that moves across pixel edges, the edges
/// are smoothed over some width. All widths are evaluated at once; the differences of their results
/// measure the bias due to the width.
inline constexpr int edge_widths = 6;

/// Smoothing kernel on (-1, 1) of integral 1 and zero second moment: its bias for a smooth density
/// is of fourth order in its width (Gasser, Mueller and Mammitzsch [gasser1985], kernels for
/// nonparametric curve estimation).
inline double edge_kernel(double u) {
  const double square = u * u;
  return square < 1 ? 15.0 / 32 * (1 - square) * (3 - 7 * square) : 0;
}

/// Pixels side by side along a coordinate, and the edges between them.
class PixelLine {
 public:
  struct Edge {
    double at;
    double size;    ///< radius or half width of the area inside the edge; 0: not an edge
    double margin;  ///< largest half width of the smoothing kernel
  };
  PixelLine() = default;
  explicit PixelLine(std::vector<Edge> edges) : edges_(std::move(edges)) {}

  std::span<const Edge> edges() const { return edges_; }
  int count() const { return static_cast<int>(edges_.size()) - 1; }
  /// Returns the pixel at a coordinate, -1 outside.
  int pixel_at(double coordinate) const;
  bool is_near(double coordinate) const {
    return coordinate > edges_.front().at - edges_.front().margin &&
           coordinate < edges_.back().at + edges_.back().margin;
  }

 private:
  std::vector<Edge> edges_;
};

/// Half width of the smoothing kernel at an edge, for light that moves by `speed` per full change
/// of the parameter. It is larger for faster light, and limited by the margin of the edge. number:
/// number of the width; each further width is half of the one before.
inline double edge_width(const PixelLine::Edge& edge, double speed, int number) {
  constexpr double far = 0.2, most = 4;
  const double reach = std::clamp(far * speed, edge.size, most * edge.size);
  return std::min(std::ldexp(reach, -number), edge.margin);
}

/// The pixels of a sensor on a face of a box, and the light that each pixel gains when light moves
/// across the face.
class SensorEdges {
 public:
  /// Throws InputError unless the sensor is a disk, rings or a rectangle, accepts all directions,
  /// and has a margin to the edges of its face.
  SensorEdges(const Sensor& sensor, const Box& stage, int first_pixel);

  /// Whether a point on the boundary is on the sensor or near one of its edges.
  bool is_near(const Vec3& x) const;
  /// Calls use(pixel, 1 / area of the pixel) for the pixel that contains x.
  template <class Use>
  void at(const Vec3& x, const Use& use) const {
    const auto [u, v] = coordinates(x);
    const int column = columns_.pixel_at(u), row = rows_.pixel_at(v);
    if (column < 0 || row < 0) return;
    const int pixel = row * columns_.count() + column;
    use(first_pixel_ + pixel, 1 / area(pixel));
  }
  /// Whether a point is on the face of the sensor.
  bool is_on_face(const Vec3& x) const { return std::abs((x - centre_).dot(outwards_)) <= near_; }
  /// Number of edges; those of size 0 are not edges of pixels.
  int edges() const { return columns_.count() + rows_.count() + 2; }
  const PixelLine::Edge& edge_at(int edge) const {
    return (is_column(edge) ? columns_ : rows_).edges()[static_cast<std::size_t>(on_line(edge))];
  }
  /// Signed distance of x beyond an edge, towards larger radius, column or row.
  double beyond(int edge, const Vec3& x) const {
    const auto [u, v] = coordinates(x);
    return is_column(edge) ? u - edge_at(edge).at : v - edge_at(edge).at;
  }
  /// Derivative of beyond() when x moves with the velocity `motion`.
  double speed(int edge, const Vec3& x, const Vec3& motion) const {
    const auto at = plane(x - centre_), by = plane(motion);
    if (is_round_) return (at.u * by.u + at.v * by.v) / std::hypot(at.u, at.v);
    return is_column(edge) ? by.u : by.v;
  }
  /// Calls use(pixel, gain divided by the area of the pixel) for the pixels on both sides of an
  /// edge, for light of unit power that crosses the edge at x towards larger radius, column or row.
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
  /// Calls use(pixel, number of the width, flow into the pixel divided by its area) for light of
  /// unit power at x. motion: derivative of x by a parameter; scale: full change of that parameter.
  template <class Use>
  void moved(const Vec3& x, const Vec3& motion, double scale, const Use& use) const {
    const auto at = plane(x - centre_), by = plane(motion);
    const double speed = std::hypot(by.u, by.v);
    if (!(speed > 0)) return;
    const Plane along{by.u / speed, by.v / speed};
    const auto cross = [&](const PixelLine::Edge& edge, double distance, const Crossing& over) {
      for (int width = 0; width < edge_widths; ++width) {
        const double reach = edge_width(edge, speed * scale, width);
        const double flux = edge_kernel(distance / reach) / reach * speed;
        if (flux == 0) continue;
        if (over.from >= 0) use(first_pixel_ + over.from, width, -flux / area(over.from));
        if (over.to >= 0) use(first_pixel_ + over.to, width, flux / area(over.to));
      }
    };
    is_round_ ? cross_rings(at, along, cross) : cross_lines(at, along, cross);
  }

 private:
  bool is_column(int edge) const { return edge <= columns_.count(); }
  /// Number of an edge on its own line, columns_ or rows_.
  int on_line(int edge) const { return is_column(edge) ? edge : edge - columns_.count() - 1; }
  struct Plane {
    double u, v;
  };
  struct Crossing {
    int from, to;  ///< pixels before and after the edge, along the line; -1: none
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
  /// Both call use(edge, distance, crossing) for the edges that a line crosses at `distance` along
  /// it: edges of rings, or of columns and rows. at: point of the line; along: direction of the
  /// line.
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
      const double distance = (edge.at - at.u) / along.u;
      const int row = rows_.pixel_at(at.v + distance * along.v);
      use(edge, distance, crossing(pixel(row, i - 1), pixel(row, i), along.u > 0));
    }
    for (int i = 0; along.v != 0 && i <= rows_.count(); ++i) {
      const PixelLine::Edge& edge = rows_.edges()[static_cast<std::size_t>(i)];
      const double distance = (edge.at - at.v) / along.v;
      const int column = columns_.pixel_at(at.u + distance * along.u);
      use(edge, distance, crossing(pixel(i - 1, column), pixel(i, column), along.v > 0));
    }
  }
  /// Coordinates of x on columns_ and rows_: (u, v), or (radius, 0) if is_round_.
  Plane coordinates(const Vec3& x) const {
    const Plane at = plane(x - centre_);
    return is_round_ ? Plane{std::hypot(at.u, at.v), 0} : at;
  }
  void set(const RadialDetector& detector, const Box& stage);
  void set(const AreaDetector& detector, const Box& stage);

  Vec3 centre_ = Vec3::Zero(), outwards_ = Vec3::Zero();
  Vec3 right_ = Vec3::Zero(), down_ = Vec3::Zero();
  bool is_round_ = false;
  PixelLine columns_,
      rows_;  ///< if is_round_, columns are rings, and there is one row without edges
  std::vector<double> areas_;
  double near_ = 0;
  int first_pixel_;
};

}  // namespace flatspeckle::grin
