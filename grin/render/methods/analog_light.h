#pragma once

#include <optional>
#include <vector>

#include "grin/media/scattering/free_flight.h"
#include "grin/render/flights/space.h"
#include "grin/render/methods/moving_field.h"
#include "grin/render/methods/path_kernels.h"
#include "grin/render/transport/transport.h"

namespace flatspeckle::grin {

/// What light on its way may be worth to sensors that are small disks on the boundary, roughly: for
/// splitting and roulette, which keep every mean whatever it says. Most light that scatters goes
/// past such sensors and is flown in vain; what heads for them is rare, and carries their errors.
class SensorAim {
 public:
  /// Nothing where a sensor is no small disk. bending: rad, of light that the field keeps.
  static std::optional<SensorAim> of(const Transport& transport, const Space& space,
                                     double bending);

  /// The first flight of light, by a place in (0, 1).
  PulledFlight first_flight(const Vec3& x, const Vec3& direction, double place) const;

  /// Before light that has arrived along a direction scatters, and of where it goes then; of light
  /// as it sets out, on average, as many parts as a path is split into to begin with.
  double before_turn(const Vec3& x, const Vec3& arrived) const {
    return worth(x, arrived, turn_) / usual_;
  }
  double towards(const Vec3& x, const Vec3& direction) const {
    return worth(x, direction, 0) / usual_;
  }

 private:
  struct Disk {
    Vec3 centre, outwards;
    double radius;
  };
  static std::optional<Disk> disk_of(const SensorEnd& sensor, const Space& space, double largest);
  SensorAim(std::vector<Disk> disks, const ScatteringMedium& medium, double bending);
  double usual(const Transport& transport, const Space& space) const;

  double worth(const Vec3& x, const Vec3& direction, double turn) const;
  double worth(const Disk& disk, const Vec3& x, const Vec3& direction, double turn) const;

  std::vector<Disk> disks_;
  double mu_t_, attenuation_, longest_, bending_, turn_, usual_ = 1;
};

/// Light paths that are counted where they hit sensors, and never joined to anything: each costs
/// little, and none is worth much more than its power. With an aim they are split where they head
/// for the sensors, and most that do not are given up. Of a space with lanes side by side; each
/// path has random numbers of its own. Unscattered light of beams is left out
/// (unscattered_beams.h). moving: the field of the space, where there are derivatives by its
/// parameters.
PathKernel analog_kernel(std::shared_ptr<const Transport> transport,
                         std::shared_ptr<const Space> space, std::optional<SensorAim> aim,
                         bool random_phase, std::shared_ptr<const MovingField> moving = nullptr);

}  // namespace flatspeckle::grin
