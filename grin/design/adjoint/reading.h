#pragma once

#include "grin/design/adjoint/ray_adjoint.h"
#include "grin/media/geometry/frame.h"

namespace flatspeckle::grin::design {

// What is read off a ray's end: K numbers, and their derivatives by the state there.

template <int K>
struct Reading {
  Eigen::Matrix<double, K, 1> values;
  RayAdjoint<K> by;
};

/// Where a ray meets the plane through a point across a frame, seen in that frame; the ray goes
/// straight on, in index 1, from where it ends.
struct ScreenReading {
  static constexpr int count = 2;
  Vec3 point, normal;
  Frame frame;

  Reading<2> operator()(const RayState& ray) const {
    const double t = normal.dot(point - ray.x) / normal.dot(ray.v);
    Reading<2> reading;
    reading.values = frame.transpose() * (ray.x + t * ray.v - point);
    const Mat3 onto = Mat3::Identity() - ray.v * normal.transpose() / normal.dot(ray.v);
    reading.by.x = onto.transpose() * frame;
    reading.by.v = t * reading.by.x;
    return reading;
  }
};

/// Where on its end surface a ray ends, seen in a frame about a point.
struct SurfaceReading {
  static constexpr int count = 2;
  Vec3 point;
  Frame frame;

  Reading<2> operator()(const RayState& ray) const {
    Reading<2> reading;
    reading.values = frame.transpose() * (ray.x - point);
    reading.by.x = frame;
    return reading;
  }
};

/// Its direction (times the index there) across a frame.
struct DirectionReading {
  static constexpr int count = 2;
  Frame frame;

  Reading<2> operator()(const RayState& ray) const {
    Reading<2> reading;
    reading.values = frame.transpose() * ray.v;
    reading.by.v = frame;
    return reading;
  }
};

/// Its optical path.
struct PathReading {
  static constexpr int count = 1;

  Reading<1> operator()(const RayState& ray) const {
    Reading<1> reading;
    reading.values[0] = ray.optical_path;
    reading.by.optical_path[0] = 1;
    return reading;
  }
};

/// Its optical path for each length along z, from where it started: n0 of a ray along the axis.
struct PathPerLengthReading {
  static constexpr int count = 1;
  double start_z;

  Reading<1> operator()(const RayState& ray) const {
    const double length = ray.x[2] - start_z;
    Reading<1> reading;
    reading.values[0] = ray.optical_path / length;
    reading.by.optical_path[0] = 1 / length;
    reading.by.x(2, 0) = -reading.values[0] / length;
    return reading;
  }
};

}  // namespace flatspeckle::grin::design
