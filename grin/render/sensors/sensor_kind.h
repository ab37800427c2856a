#pragma once

#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/keys/keys.h"
#include "core/result/dataset_row.h"
#include "grin/media/scattering/start_directions.h"
#include "grin/render/endpoints/boundary_patch.h"
#include "grin/render/endpoints/path_end.h"
#include "grin/render/sensors/pixel_grid.h"

namespace flatspeckle::grin {

/// Directions in which a surface accepts light: within an angle from its outward normal. W of
/// path_end.h is `sensitivity` within this angle and 0 beyond.
class Acceptance {
 public:
  explicit Acceptance(double angle) : sine_squared_(std::sin(angle) * std::sin(angle)) {}

  /// Tangent of the angle; infinite if all directions are accepted.
  double tangent() const { return std::sqrt(sine_squared_ / (1 - sine_squared_)); }

  EndDirection sample(const EndPosition& at, double sensitivity, RandomStream& random) const {
    const double squared = sine_squared_ * random.uniform();
    return towards(at, random_turn(at.inward, squared / (1 + std::sqrt(1 - squared)), random),
                   sensitivity);
  }
  EndDirection towards(const EndPosition& at, const Vec3& direction, double sensitivity) const {
    EndDirection to{.direction = direction};
    const double cosine = direction.dot(at.inward);
    if (!(cosine > 0 && 1 - cosine * cosine <= sine_squared_)) return to;
    to.density = cosine / (std::numbers::pi * sine_squared_);
    to.pixel = at.pixel;
    to.strength = at.index * at.index * cosine * sensitivity;
    return to;
  }

 private:
  double sine_squared_;
};

/// Names and units in the datasets of a kind of sensor.
struct SensorWords {
  std::string name;
  std::vector<DatasetRow> axes;  ///< axes of the picture
  std::string unit;              ///< unit of a pixel's value and of the mean
  std::string pixel, mean;
  /// Description of the total, which is a power. If empty, the file contains no total, and the
  /// pulse is that of the mean over the pixels.
  std::string total = {};
};

/// Returns the datasets of a sensor: picture, mean and total; the same quantities in each bin of
/// optical path, and before and after all bins; mean and mean squared optical path; derivatives by
/// parameters.
DatasetTable sensor_table(const SensorWords& words);

// The file of a kind of sensor declares: the sensor; table_of(sensor), its datasets;
// picture_of(sensor), its pixels; nearest_place(sensor, boundary); its End, a path endpoint
// constructed from (sensor, stage), which throws InputError naming the key if the sensor does not
// fit the stage; the values of its keys, with the value of the key `sensor` that selects the kind;
// add_keys(keys, values); and make_sensor(of, values, picture), where `of` reads the values of one
// sensor, and `picture` is left out if the pixels are rings. The kind is listed in sensor.h.
//
// The endpoint has pixels(), sample_position(stratum, random), sample_direction(at, stratum,
// random), towards(at, direction), and position_at(x), the position at a point on the boundary, if
// the sensor can be hit there. It may also have choose_position(x, random) and choice(position, x)
// for connections from x, and can_be_hit().

/// The pixels of a sensor with their axes in the result file.
struct SensorPixels {
  struct Axis {
    const char* name;
    std::vector<double> middles;
  };
  PixelGrid grid;
  double area;  ///< area or solid angle of all pixels
  std::vector<Axis> axes;
  std::vector<double> shares = {};  ///< fraction of the area in each pixel; empty: equal fractions

  double share(std::size_t pixel) const {
    return shares.empty() ? 1.0 / grid.count() : shares[pixel];
  }
};

/// Function that returns the point of a sensor nearest to a given point in the stage.
using NearestPlace = std::function<Vec3(const Vec3&)>;
/// Makes a function that returns the nearest point on the half of the boundary through which light
/// along `forward` leaves.
NearestPlace in_front(const Vec3& forward, const Surface& boundary);

/// Endpoint positions distributed uniformly over the whole boundary.
class WholeBoundary {
 public:
  /// Throws InputError.
  explicit WholeBoundary(const Stage& stage)
      : boundary_(stage.boundary, "sensor"), regions_(stage) {}

  EndPosition sample_position(double, RandomStream& random) const {
    return at(boundary_.sample(random));
  }
  std::optional<EndPosition> position_at(const Vec3& x) const {
    return at({x, boundary_.inward(x)});
  }

 private:
  EndPosition at(const BoundaryPoint& at) const {
    return {.point = {at.x, regions_.at(at.x)},
            .inward = at.inward,
            .position_density = 1 / boundary_.area()};
  }

  BoundaryPatch boundary_;
  Regions regions_;
};

/// Values of a sensor that all kinds with a rectangle of pixels have in common.
struct Picture {
  Vec3 up;
  PixelGrid pixels;
};

/// Reads the values of one sensor. A key has one value for each sensor, or one for all. Throws
/// InputError if a key has no value or another number of values.
class OneSensor {
 public:
  OneSensor(const Keys& keys, std::size_t number, std::size_t sensors)
      : keys_(keys), number_(number), sensors_(sensors) {}

  template <class Number>
  std::span<const Number> part(const std::vector<Number>& member, std::size_t size) const {
    const std::size_t given = keys_.required(member).size();
    if (given != size && given != size * sensors_)
      throw InputError(keys_.name(member) +
                       ": must have one value for all sensors, or one for each of the " +
                       std::to_string(sensors_));
    return std::span(member).subspan(given > size ? number_ * size : 0, size);
  }
  /// Returns the values of a key that is common to all sensors.
  const std::vector<double>& all(const std::vector<double>& member) const {
    return keys_.read(member);
  }
  /// Throws InputError if the key of `member` is given, since the key `other` replaces it.
  template <class Member>
  void refuse_beside(const std::string& other, const Member& member) const {
    if (keys_.given(member))
      throw InputError(keys_.name(member) + ": must not be given together with " + other);
  }
  Vec3 vector(const std::vector<double>& member) const { return vector_of(part(member, 3)); }
  double number(const std::vector<double>& member) const { return part(member, 1)[0]; }

 private:
  const Keys& keys_;
  std::size_t number_, sensors_;
};

/// Adds a key that has three numbers, x y z, for each sensor.
inline Key& add_vectors(Keys& keys, const std::string& name, std::vector<double>& member,
                        const std::string& help) {
  return keys.add(name, member, help).each_of(3, "x y z");
}

}  // namespace flatspeckle::grin
