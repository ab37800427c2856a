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

/// Of light that arrives on a surface within an angle from its outward normal: W of path_end.h is
/// `reading` there and 0 beyond.
class Acceptance {
 public:
  explicit Acceptance(double angle) : sine_squared_(std::sin(angle) * std::sin(angle)) {}

  /// Infinite for all directions.
  double tangent() const { return std::sqrt(sine_squared_ / (1 - sine_squared_)); }

  EndDirection sample(const EndPosition& at, double reading, RandomStream& random) const {
    const double squared = sine_squared_ * random.uniform();
    return towards(at, random_turn(at.inward, squared / (1 + std::sqrt(1 - squared)), random),
                   reading);
  }
  EndDirection towards(const EndPosition& at, const Vec3& direction, double reading) const {
    EndDirection to{.direction = direction};
    const double cosine = direction.dot(at.inward);
    if (!(cosine > 0 && 1 - cosine * cosine <= sine_squared_)) return to;
    to.density = cosine / (std::numbers::pi * sine_squared_);
    to.pixel = at.pixel;
    to.strength = at.index * at.index * cosine * reading;
    return to;
  }

 private:
  double sine_squared_;
};

/// What a kind of sensor calls what it finds.
struct SensorWords {
  std::string name;
  std::vector<DatasetRow> axes;  ///< of a pixel
  std::string unit;              ///< of a pixel and of the mean
  std::string pixel, mean;
  std::string total = {};  ///< a power; none: there is no total, and pulses are of the mean
};

/// Pictures and what they add up to; the same of bins of optical path and beyond them; the mean
/// optical path and the mean of its square; derivatives by parameters of the medium.
DatasetTable sensor_table(const SensorWords& words);

// A kind of sensor is a file with: the sensor; table_of(sensor), what its result file has,
// picture_of(sensor), its pixels, and nearest_place(sensor, boundary); its End, an end of paths
// made of (sensor, stage), which throws InputError naming the key where it does not fit the stage;
// its values, with the word of the key `sensor` for it; add_keys(keys, values) and make_sensor(of,
// values, picture), without the picture where its pixels are rings; `of` reads what the values have
// for it. It is listed in sensor.h.
//
// The end tells pixels(), has sample_position(stratum, random), sample_direction(at, stratum,
// random) and towards(at, direction), and position_at(x) of a point on the boundary, if it can be
// hit there. Where it may, it has choose_position(x, random) and choice(position, x) for joins from
// x, and can_be_hit().

/// The pixels of a sensor, as its file has them.
struct SensorPixels {
  struct Axis {
    const char* name;
    std::vector<double> middles;
  };
  PixelGrid grid;
  double area;  ///< of all, in the plane or solid angle that they divide
  std::vector<Axis> axes;
  std::vector<double> shares = {};  ///< of each in the area; none: all have the same

  double share(std::size_t pixel) const {
    return shares.empty() ? 1.0 / grid.count() : shares[pixel];
  }
};

/// Where straight light from a point in the stage gets to a sensor soonest.
using NearestPlace = std::function<Vec3(const Vec3&)>;
/// On the half of the boundary that light of this direction leaves through.
NearestPlace in_front(const Vec3& forward, const Surface& boundary);

/// All of the boundary, evenly, as the places of an end.
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

/// What all kinds with a rectangle have.
struct Picture {
  Vec3 up;
  PixelGrid pixels;
};

/// What one of a scene's sensors reads of keys, which have numbers for each sensor or the same for
/// all. Throws InputError for what is not given, or for another number of sensors.
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
  /// The same of all sensors.
  const std::vector<double>& all(const std::vector<double>& member) const {
    return keys_.read(member);
  }
  /// What another key stands in the place of. Throws InputError.
  template <class Member>
  void refuse_beside(const std::string& other, const Member& member) const {
    if (keys_.given(member))
      throw InputError(keys_.name(member) + ": must not be given beside " + other);
  }
  Vec3 vector(const std::vector<double>& member) const { return vector_of(part(member, 3)); }
  double number(const std::vector<double>& member) const { return part(member, 1)[0]; }

 private:
  const Keys& keys_;
  std::size_t number_, sensors_;
};

/// The row of x y z for each sensor.
inline Key& add_vectors(Keys& keys, const std::string& name, std::vector<double>& member,
                        const std::string& help) {
  return keys.add(name, member, help).each_of(3, "x y z");
}

}  // namespace flatspeckle::grin
