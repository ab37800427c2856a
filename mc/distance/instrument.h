#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/keys/keys.h"
#include "flatland/scene/scene.h"
#include "mc/distance/distance_job.h"

namespace flatspeckle::mc {

/// Values of the keys of a laser and of cameras or photon counters at each distance.
struct InstrumentValues {
  std::optional<double> source_power, fibre_modes, pixel_area;
  double quantum_efficiency = 1, read_noise = 0, averaging_time = 1, other_flow_error = 0.1;
  std::int64_t detector_count = 1;
  std::vector<std::int64_t> flow_layers{};
};
void add_keys(Keys& keys, InstrumentValues& values);

/// Instrument that measures the flow of blood. At each distance it has `count` pixels or fibres.
struct Instrument {
  double photons = 0;  ///< photons of the source per second, times the quantum efficiency
  double modes = 0;    ///< modes of light on a pixel or fibre, both polarisations counted
  double density = 0;  ///< modes of light per area of the surface
  double count = 1, read_noise = 0, averaging_time = 1;
  double beta = 1;              ///< from the modes
  double squares = 1;           ///< CountedSpeckle::squares, over pixels
  double other_flow_error = 0;  ///< relative error to which the flow of other layers is known
  std::vector<std::int64_t> layers{};  ///< numbers of those whose flow is measured; empty: all
  /// Diffusion factors of these layers and of all others; 0 for layers that do not belong to them.
  std::vector<double> flow{}, others{};
};
/// Returns the instrument, without diffusion factors, if the keys describe one. Throws InputError.
std::optional<Instrument> make_instrument(const Keys& keys, const InstrumentValues& values,
                                          const SceneSpec& spec, const DistanceRequest& request);
/// Sets the diffusion factors. Throws InputError if the layers do not exist or do not move.
void set_flow(Instrument& instrument, const Scene& scene);

}  // namespace flatspeckle::mc
