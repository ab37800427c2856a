#include "grin/render/methods/sensor_aim.h"

#include <algorithm>
#include <cmath>

namespace flatspeckle::grin {

namespace {

// Found by trials with guides of sound in tissue of three mean free paths. Where it is far from
// what is so, variance is lost.
constexpr double share_lost = 0.7;  // of light that scatters on its way along a guide
constexpr double share_kept = 0.6;  // of the angles that a field keeps
constexpr double spread = 0.5;      // rad, of light that still scatters before the sensor
constexpr double deepest = 3;       // mean free paths that are seen ahead
constexpr double least = 1.0 / 32;  // of what heads elsewhere: none that returns is worth too much

constexpr double parts = 2;  // of a path to begin with: they share its first flight

constexpr int some = 64;  // samples of ends

RandomStream stream_of_trials() {
  return {0, static_cast<std::uint64_t>(Stream::render), 0};
}

}  // namespace

std::optional<SensorAim> SensorAim::of(const Transport& transport, const Space& space,
                                       double bending) {
  constexpr double small = 0.1;  // of the stage
  const ScatteringMedium& medium = transport.stage.medium;
  if (!(medium.mu_s > 0)) return std::nullopt;
  const Box box = bounds(transport.stage.boundary);
  std::vector<Disk> disks;
  for (const SensorEnd& sensor : transport.sensors) {
    const auto disk = disk_of(sensor, space, small * (box.high - box.low).maxCoeff());
    if (!disk) return std::nullopt;
    disks.push_back(*disk);
  }
  SensorAim aim(std::move(disks), medium, bending);
  aim.usual_ = aim.usual(transport, space);
  return aim;
}

/// About as large as the sensor's places are spread; nothing where that is too large, or bent.
std::optional<SensorAim::Disk> SensorAim::disk_of(const SensorEnd& sensor, const Space& space,
                                                  double largest) {
  constexpr double flat = 0.99;
  RandomStream random = stream_of_trials();
  std::vector<Vec3> places;
  Vec3 centre = Vec3::Zero(), outwards = Vec3::Zero();
  for (int i = 0; i < some; ++i) {
    const EndPosition at = sensor.sample_position(space, random, (i + 0.5) / some);
    places.push_back(at.point.x);
    centre += at.point.x / some;
    outwards -= at.inward / some;
  }
  double square = 0;
  for (const Vec3& place : places) square += (place - centre).squaredNorm() / some;
  const double radius = std::sqrt(square);
  if (!(outwards.norm() > flat && radius > 0 && radius < largest)) return std::nullopt;
  return Disk{centre, outwards.normalized(), radius};
}

SensorAim::SensorAim(std::vector<Disk> disks, const ScatteringMedium& medium, double bending)
    : disks_(std::move(disks)),
      mu_t_(medium.mu_t()),
      attenuation_(share_lost * medium.mu_t()),
      longest_(deepest / medium.mu_t()),
      bending_(share_kept * bending),
      turn_(1 - std::abs(medium.phase.mean_cosine())) {}

double SensorAim::usual(const Transport& transport, const Space& space) const {
  RandomStream random = stream_of_trials();
  double sum = 0;
  for (int i = 0; i < some; ++i) {
    const EndPosition at = transport.lights.sample_position(space, random);
    sum += worth(at.point.x, transport.lights.sample_direction(at, random).direction, 0);
  }
  return sum / some / parts;
}

PulledFlight SensorAim::first_flight(const Vec3& x, const Vec3& direction, double place) const {
  constexpr double bent = 1.02;  // longer than the straight way
  double depth = 0;
  for (const Disk& disk : disks_) {
    const double left = disk.outwards.dot(disk.centre - x), cosine = disk.outwards.dot(direction);
    if (cosine > 0) depth = std::max(depth, bent * mu_t_ * left / cosine);
  }
  return PulledFlight::at(place, std::min(depth, deepest / share_lost), share_lost);
}

double SensorAim::worth(const Vec3& x, const Vec3& direction, double turn) const {
  double most = 0;
  for (const Disk& disk : disks_) most = std::max(most, worth(disk, x, direction, turn));
  return most;
}

/// By where a straight way leads: to the sensor's plane, or some mean free paths on.
double SensorAim::worth(const Disk& disk, const Vec3& x, const Vec3& direction, double turn) const {
  const Vec3 to_centre = disk.centre - x;
  const double left = disk.outwards.dot(to_centre), cosine = disk.outwards.dot(direction);
  const double flight = left < longest_ * cosine ? left / cosine : longest_;
  const Vec3 off = to_centre - flight * direction;
  const double left_then = std::max(0.0, disk.outwards.dot(off));
  const double aside = (off - disk.outwards.dot(off) * disk.outwards).norm();
  const double reach =
      disk.radius + bending_ * left + turn * std::min(left, longest_) + spread * left_then;
  const double hits = reach / aside, share = hits < 1 ? std::max(hits * hits * hits, least) : 1;
  const double depth = attenuation_ * (cosine > 0 ? left : left_then);
  return share * std::exp(-std::min(depth, deepest));
}

}  // namespace flatspeckle::grin
