#include "grin/estimators/unscattered_beams.h"

#include <cmath>
#include <numbers>

#include "grin/space/straight_space.h"

namespace flatspeckle::grin {

namespace {

class EvenSquare {
 public:
  explicit EvenSquare(RandomStream& random) : u_(random.uniform()), v_(random.uniform()) {}

  double u(int i) const { return fraction(u_ + i / plastic); }
  double v(int i) const { return fraction(v_ + i / (plastic * plastic)); }

 private:
  static constexpr double plastic = 1.32471795724474602596;  // x^3 = x + 1
  static double fraction(double x) { return x - std::floor(x); }
  double u_, v_;
};

template <bool timed, Space S>
void add_ray(const Transport& transport, const S& space, const EndPosition& start,
             RandomStream& random, Film& film, TransportCounts& counts) {
  const Flight flight = space.fly(start.point, start.inward, random);
  counts.add_flight(flight.end == Flight::End::lost);
  if (flight.end == Flight::End::lost) return;
  for (const SensorEnd& sensor : transport.sensors)
    sensor.hit(space, flight.point.x, flight.direction, [&](const EndHit& hit) {
      deposit<timed>(film, counts, hit.direction.pixel,
                     transport.lights.beam_power() * flight.weight * hit.value,
                     flight.optical_path);
    });
}

/// with_space(use): calls use(space), the same or another for each ray.
template <bool timed, class WithSpace>
PathKernel kernel(std::shared_ptr<const Transport> transport, const WithSpace& with_space) {
  return [=](int rays, RandomStream& random, Film& film, TransportCounts& counts,
             std::vector<double>*) {
    const EvenSquare even(random);
    const double beam = random.uniform();
    for (int ray = 0; ray < rays; ++ray) {
      const EndPosition start =
          transport->lights.beam_position((ray + beam) / rays, even.u(ray), even.v(ray));
      with_space(random, [&](const auto& space) {
        add_ray<timed>(*transport, space, start, random, film, counts);
      });
    }
  };
}

template <class WithSpace>
PathKernel kernel(bool timed, std::shared_ptr<const Transport> transport,
                  const WithSpace& with_space) {
  return timed ? kernel<true>(transport, with_space) : kernel<false>(transport, with_space);
}

}  // namespace

PathKernel beams_kernel(bool timed, std::shared_ptr<const Transport> transport, double excess) {
  using Straight = StraightSpace<RenderPlan{.curved = false, .scatters = false}>;
  const Straight space(without_scattering(transport->stage), excess);
  return kernel(timed, transport, [=](RandomStream&, const auto& use) { use(space); });
}

PathKernel beams_kernel(bool timed, std::shared_ptr<const Transport> transport,
                        std::shared_ptr<const CurvedSpace> space, bool random_phase) {
  return kernel(timed, transport, [=](RandomStream& random, const auto& use) {
    if (random_phase)
      use(*space->frozen(2 * std::numbers::pi * random.uniform()));
    else
      use(*space);
  });
}

}  // namespace flatspeckle::grin
