#pragma once

#include "grin/design/adjoint/ray_adjoint.h"
#include "grin/media/geometry/frame.h"

namespace flatspeckle::grin::design {

// A measurement of a ray consists of K numbers at its end, and of their derivatives with respect to
// the state of the ray there.

template <int K>
struct RayMeasurement {
  Eigen::Matrix<double, K, 1> values;
  RayAdjoint<K> by;
};

/// Intersection of a ray with the plane that contains `point` and the two vectors of a frame, in
/// coordinates of this frame. The ray continues straight from its end, in index 1.
struct ScreenMeasurement {
  static constexpr int count = 2;
  Vec3 point, normal;
  Frame frame;

  RayMeasurement<2> operator()(const RayState& ray) const {
    const double t = normal.dot(point - ray.x) / normal.dot(ray.v);
    RayMeasurement<2> measurement;
    measurement.values = frame.transpose() * (ray.x + t * ray.v - point);
    const Mat3 onto = Mat3::Identity() - ray.v * normal.transpose() / normal.dot(ray.v);
    measurement.by.x = onto.transpose() * frame;
    measurement.by.v = t * measurement.by.x;
    return measurement;
  }
};

/// Position of the ray's end on its end surface, in coordinates of a frame about `point`.
struct SurfaceMeasurement {
  static constexpr int count = 2;
  Vec3 point;
  Frame frame;

  RayMeasurement<2> operator()(const RayState& ray) const {
    RayMeasurement<2> measurement;
    measurement.values = frame.transpose() * (ray.x - point);
    measurement.by.x = frame;
    return measurement;
  }
};

/// Two transverse components of the ray's unit direction, multiplied by the index.
struct DirectionMeasurement {
  static constexpr int count = 2;
  Frame frame;

  RayMeasurement<2> operator()(const RayState& ray) const {
    RayMeasurement<2> measurement;
    measurement.values = frame.transpose() * ray.v;
    measurement.by.v = frame;
    return measurement;
  }
};

/// Optical path of the ray.
struct PathMeasurement {
  static constexpr int count = 1;

  RayMeasurement<1> operator()(const RayState& ray) const {
    RayMeasurement<1> measurement;
    measurement.values[0] = ray.optical_path;
    measurement.by.optical_path[0] = 1;
    return measurement;
  }
};

/// Optical path divided by the length along z from the start of the ray. Equals n0 for a ray on the
/// axis.
struct PathPerLengthMeasurement {
  static constexpr int count = 1;
  double start_z;

  RayMeasurement<1> operator()(const RayState& ray) const {
    const double length = ray.x[2] - start_z;
    RayMeasurement<1> measurement;
    measurement.values[0] = ray.optical_path / length;
    measurement.by.optical_path[0] = 1 / length;
    measurement.by.x(2, 0) = -measurement.values[0] / length;
    return measurement;
  }
};

}  // namespace flatspeckle::grin::design
