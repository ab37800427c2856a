#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>

#include "core/numbers/random.h"
#include "grin/media/geometry/vector_values.h"

namespace flatspeckle::grin {

/// A grid of pixels with row 0 on top; a pixel has the number row * columns + column.
struct PixelGrid {
  int columns = 1, rows = 1;
  int count() const { return columns * rows; }
};

/// A point of a picture and its pixel. From the centre of the picture, u increases to the right and
/// v upwards.
struct PicturePoint {
  double u, v;
  int pixel;
};

struct Window {
  double u_low, u_high, v_low, v_high;

  double area() const { return (u_high - u_low) * (v_high - v_low); }
  bool contains(double u, double v) const {
    return u >= u_low && u <= u_high && v >= v_low && v <= v_high;
  }
};

/// A rectangle of pixels, |u| <= half_width, |v| <= half_height.
class PixelRectangle {
 public:
  PixelRectangle(const PixelGrid& grid, double half_width, double half_height)
      : grid_(grid), half_width_(half_width), half_height_(half_height) {}

  const PixelGrid& grid() const { return grid_; }
  double half_width() const { return half_width_; }
  double half_height() const { return half_height_; }
  double area() const { return 4 * half_width_ * half_height_; }
  /// Returns the part of the rectangle within a square about (u, v); the whole rectangle if the two
  /// do not overlap.
  Window near(double u, double v, double half_side) const {
    const Window part{std::max(u - half_side, -half_width_), std::min(u + half_side, half_width_),
                      std::max(v - half_side, -half_height_),
                      std::min(v + half_side, half_height_)};
    if (part.u_low < part.u_high && part.v_low < part.v_high) return part;
    return all();
  }
  Window all() const { return {-half_width_, half_width_, -half_height_, half_height_}; }
  double pixel_area() const { return area() / grid_.count(); }

  /// Centres of columns from left to right, and of rows from top to bottom.
  std::vector<double> column_centres() const { return centres(half_width_, grid_.columns); }
  std::vector<double> row_centres() const {
    auto rows = centres(half_height_, grid_.rows);
    for (double& v : rows) v = -v;
    return rows;
  }

  /// Returns the pixel at (u, v), -1 outside.
  int pixel_at(double u, double v) const {
    const double column = (u / half_width_ + 1) / 2 * grid_.columns;
    const double row = (1 - v / half_height_) / 2 * grid_.rows;
    if (!(column >= 0 && column <= grid_.columns && row >= 0 && row <= grid_.rows)) return -1;
    return std::min(static_cast<int>(row), grid_.rows - 1) * grid_.columns +
           std::min(static_cast<int>(column), grid_.columns - 1);
  }

  /// Samples a point. `stratum` selects the pixel; the point is uniformly distributed if `stratum`
  /// is uniform in (0, 1).
  PicturePoint sample(double stratum, RandomStream& random) const {
    const int pixel = std::min(static_cast<int>(stratum * grid_.count()), grid_.count() - 1);
    const int rows_above = pixel / grid_.columns;
    const double column = pixel % grid_.columns + random.uniform();
    const double row = rows_above + random.uniform();
    return {half_width_ * (2 * column / grid_.columns - 1),
            half_height_ * (1 - 2 * row / grid_.rows), pixel};
  }

 private:
  /// Centres of `count` equal intervals of (-half, half).
  static std::vector<double> centres(double half, int count) {
    std::vector<double> values;
    for (int i = 0; i < count; ++i) values.push_back(half * ((2 * i + 1.0) / count - 1));
    return values;
  }

  PixelGrid grid_;
  double half_width_, half_height_;
};

/// Orientation of a picture: right = forward x up.
struct Orientation {
  Vec3 forward, right, up;  ///< unit vectors at right angles

  /// Throws InputError if `along` is zero (naming forward_key), or if `upwards` is zero or parallel
  /// to it (naming sensor_up).
  Orientation(const char* forward_key, const Vec3& along, const Vec3& upwards)
      : forward(unit_direction(forward_key, along)) {
    const Vec3 unit_up = unit_direction("sensor_up", upwards);
    const Vec3 across = forward.cross(unit_up);
    if (!(across.norm() > 1e-6))
      throw InputError("sensor_up", listed(upwards), "must not be parallel to the view direction");
    right = across.normalized();
    up = right.cross(forward);
  }
};

}  // namespace flatspeckle::grin
