#include "grin/render/methods/map_kernel.h"

#include <cmath>
#include <numbers>

#include "grin/render/transport/subpath.h"

namespace flatspeckle::grin {

namespace {

/// Of a light path, whose stretches are added to a map.
template <class Cells>
class MapTally : public LightTally {
 public:
  MapTally(const Cells& cells, const Transport& transport, std::span<Complex> sums,
           EnergyBalance& energy, TransportCounts& counts)
      : LightTally(energy), cells_(cells), transport_(transport), sums_(sums), counts_(counts) {}

  Flight fly(const Space& space, const PathVertex& from, const Vec3& direction,
             RandomStream& random, const Vec3* rise) {
    log_.clear();
    const Flight flight = space.fly(from.point, direction, random, &log_, rise);
    const double weight = from.weight * flight.stretched;
    for (const FlightLeg& leg : log_) {
      const ScatteringMedium& medium = transport_.medium(leg.start.part);
      const double apart = std::max(cells_.spacing(), leg.length / most_points);
      space.for_points(leg, apart, random,
                       [&](const Vec3& x, double length) { add(x, weight * length, medium); });
    }
    return flight;
  }

 private:
  static constexpr double most_points = 256;

  void add(const Vec3& x, double power_length, const ScatteringMedium& medium) {
    const int cell = cells_.cell_at(x);
    if (cell < 0) return;
    const double fluence = power_length / cells_.volume(cell);
    if (!std::isfinite(fluence)) {
      ++counts_.lost_values;
      return;
    }
    Complex* const sums = &sums_[sums_per_cell * static_cast<std::size_t>(cell)];
    sums[0] += fluence;
    sums[1] += fluence * medium.absorption(x);
  }

  const Cells& cells_;
  const Transport& transport_;
  std::span<Complex> sums_;
  TransportCounts& counts_;
  FlightLog log_;
};

template <class Tally>
void walk_light(const Transport& transport, const Space& space, RandomStream& random, Tally& tally,
                TransportCounts& counts) {
  LonePath alone;
  const EndPosition end = transport.lights.sample_position(space, random);
  const PathVertex start = end_vertex(transport.strategies, end);
  const EndDirection first = transport.lights.sample_direction(end, random);
  walk(
      transport, space, never_chosen, start, first, false, random, counts, alone, tally,
      [](const PathVertex&) {}, [](const PathVertex&, const PathVertex&) {});
  tally.end_path();
}

}  // namespace

MapKernel map_kernel(const LightMap& map, std::shared_ptr<const Transport> transport,
                     std::shared_ptr<const Space> space, bool random_phase) {
  return [=](int paths, RandomStream& random, std::span<Complex> sums, EnergyBalance& energy,
             TransportCounts& counts) {
    std::visit(
        [&](const auto& cells) {
          MapTally tally(cells, *transport, sums, energy, counts);
          for (int path = 0; path < paths; ++path) {
            if (random_phase) {
              const auto met = space->frozen(2 * std::numbers::pi * random.uniform());
              walk_light(*transport, *met, random, tally, counts);
            } else {
              walk_light(*transport, *space, random, tally, counts);
            }
          }
        },
        map);
  };
}

}  // namespace flatspeckle::grin
