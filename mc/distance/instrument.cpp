#include "mc/distance/instrument.h"

#include <algorithm>
#include <functional>
#include <numbers>
#include <string>

#include "core/error.h"
#include "core/numbers/constants.h"
#include "mc/theory/detector_noise.h"

namespace flatspeckle::mc {

namespace {

/// Smallest number of delays above 0 from which the decay of light is interpolated.
constexpr std::ptrdiff_t least_delays = 4;

void check_delays_of_plan(const DistanceRequest& request) {
  const auto& delays = request.dynamics.delays;
  if (!request.dynamics.diffusion)
    throw InputError("source_power: requires delays in s: give delays, and diffusion in m^2/s");
  if (!std::ranges::is_sorted(delays, std::ranges::less_equal{}) ||
      std::ranges::count_if(delays, [](double delay) { return delay > 0; }) < least_delays)
    throw InputError("delays", delays.back(),
                     "source_power requires ascending delays, at least four of them above 0");
}

}  // namespace

void add_keys(Keys& keys, InstrumentValues& values) {
  keys.group("Instrument", "results with source_power");
  keys.add("source_power", values.source_power,
           "Power of the laser; the noise of an instrument and the error of the flow are then also "
           "computed")
      .positive()
      .unit("W")
      .only_of("delays in s");
  keys.add("quantum_efficiency", values.quantum_efficiency,
           "Probability that a photon on a pixel or fibre is detected")
      .positive_to(1);
  keys.add("detector_count", values.detector_count, "Number of pixels or fibres at each distance")
      .positive();
  keys.add("fibre_modes", values.fibre_modes,
           "Number of modes of each fibre, both polarisations counted: 2 for a single-mode fibre, "
           "1 behind a polariser; beta is its reciprocal")
      .from(1, 1e9)
      .only_of("source_power without pixel_area");
  keys.add("pixel_area", values.pixel_area,
           "Area of a pixel of a camera divided by that of a speckle on it; beta follows, for "
           "unpolarised light")
      .from(0.01, 1e6)
      .only_of("source_power without fibre_modes");
  keys.add("read_noise", values.read_noise,
           "Standard deviation of the camera's read noise, in electrons per pixel and exposure")
      .not_negative()
      .only_of("exposures with source_power");
  keys.add("averaging_time", values.averaging_time,
           "Time from which each value of the flow is measured; exposures follow without gaps")
      .positive()
      .unit("s");
  keys.add("flow_layers", values.flow_layers,
           "Numbers of the layers, from 0 at the surface, whose flow is measured (default: all)")
      .only_of("layers with source_power");
  keys.add("other_flow_error", values.other_flow_error,
           "Relative standard error to which the flow of all other layers is known; 0: exactly")
      .not_negative()
      .only_of("flow_layers");
}

std::optional<Instrument> make_instrument(const Keys& keys, const InstrumentValues& values,
                                          const SceneSpec& spec, const DistanceRequest& request) {
  if (!keys.read(values.source_power)) return std::nullopt;
  check_delays_of_plan(request);
  const auto fibre = keys.read(values.fibre_modes), area = keys.read(values.pixel_area);
  if (fibre.has_value() == area.has_value())
    throw InputError("fibre_modes, pixel_area: source_power requires exactly one of them");
  constexpr double polarisations = 2;
  Instrument instrument;
  if (fibre) {
    instrument.modes = *fibre;
    instrument.beta = 1 / *fibre;
  } else {
    const PixelSpeckle speckle = pixel_speckle(*area);
    instrument.modes = polarisations * *area;
    instrument.beta = 1 / (polarisations * speckle.modes);
    instrument.squares = speckle.squares;
  }
  const double wavelength = keys.read(spec.wavelength), outside = spec.outside_index.value_or(1),
               photon_energy = planck_constant * light_speed / (wavelength * *request.length_unit);
  instrument.photons = *values.source_power * keys.read(values.quantum_efficiency) / photon_energy;
  const double aperture = std::min(request.numerical_aperture, outside) / wavelength;
  instrument.density = polarisations * std::numbers::pi * aperture * aperture;
  instrument.count = static_cast<double>(keys.read(values.detector_count));
  for (const DistanceDetector& detector : request.detectors) {
    const double most = instrument.density * detector.area();
    if (instrument.count * instrument.modes > most)
      throw InputError("detector_count", values.detector_count,
                       "the pixels or fibres must not have more modes than the light on a "
                       "detector, " +
                           std::to_string(most));
  }
  if (!request.dynamics.exposure.times.empty())
    instrument.read_noise = keys.read(values.read_noise);
  instrument.averaging_time = keys.read(values.averaging_time);
  for (const double time : request.dynamics.exposure.times)
    if (time > instrument.averaging_time)
      throw InputError("exposures", time, "must not exceed averaging_time");
  if (!spec.layers.empty() && !keys.read(values.flow_layers).empty()) {
    instrument.layers = values.flow_layers;
    instrument.other_flow_error = keys.read(values.other_flow_error);
  }
  return instrument;
}

void set_flow(Instrument& instrument, const Scene& scene) {
  std::vector<double> factors{1};
  if (scene.profile) {
    factors.clear();
    for (const Material& material : scene.profile->materials())
      factors.push_back(material.motion.diffusion);
  }
  instrument.flow.assign(factors.size(), 0);
  instrument.others = instrument.flow;
  for (const std::int64_t layer : instrument.layers)
    if (layer < 0 || layer >= static_cast<std::int64_t>(factors.size()))
      throw InputError("flow_layers", layer,
                       "must be below the number of layers, " + std::to_string(factors.size()));
  for (std::size_t layer = 0; layer < factors.size(); ++layer) {
    const bool wanted = instrument.layers.empty() ||
                        std::ranges::count(instrument.layers, static_cast<std::int64_t>(layer)) > 0;
    (wanted ? instrument.flow : instrument.others)[layer] = factors[layer];
  }
  if (std::ranges::all_of(instrument.flow, [](double factor) { return factor == 0; }))
    throw InputError("flow_layers: requires a layer that moves, with a diffusion factor above 0");
}

}  // namespace flatspeckle::mc
