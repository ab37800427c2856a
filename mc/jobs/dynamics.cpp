#include "mc/jobs/dynamics.h"

#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/keys/written_number.h"
#include "core/numbers/constants.h"

namespace flatspeckle::mc {

void add_keys(Keys& keys, DynamicsValues& values) {
  keys.add("delays", values.delays,
           "Also estimate the field correlation after these delays tau, during which the "
           "scatterers diffuse: times such as 1us:10ms:20:log (in s without a unit) if diffusion "
           "has a unit or temperature is given; otherwise plain numbers k^2 D tau, or those in the "
           "unit of time of diffusion")
      .only_of("method = mc or transport");
  add_motion_keys(keys, values);
  keys.add("exposures", values.exposures,
           "Also estimate the squared speckle contrast K^2 for these exposure times, in the unit "
           "of the delays, up to the longest delay")
      .only_of("delays");
  keys.add("beta", values.beta,
           "Coherence factor: squared speckle contrast K^2 of static scatterers, and g2 - 1 at "
           "delay 0")
      .positive_to(1)
      .only_of("delays with covariance = intensity");
}

void add_motion_keys(Keys& keys, DynamicsValues& values) {
  keys.add("diffusion", values.diffusion,
           "Diffusion constant D of the scatterers, such as \"4.3e-13 m^2/s\"; or, as a plain "
           "number, k^2 D per unit of delay (default: 1)")
      .only_of("delays");
  keys.add("temperature", values.temperature,
           "Temperature of the liquid, which gives the diffusion constant D = k_B temperature / (6 "
           "pi viscosity particle_radius)")
      .from(200, 1000)
      .unit("K")
      .only_of("delays");
  keys.add("viscosity", values.viscosity, "Viscosity of the liquid")
      .positive()
      .unit("Pa s")
      .only_of("delays with temperature");
  keys.add("particle_radius", values.particle_radius,
           "Radius of the particles that diffuse (default: that of the scatterers)")
      .positive()
      .unit("length")
      .only_of("delays with temperature");
  keys.add("velocity", values.velocity,
           "Velocity of the scatterers, v_x and v_z and, in space, v_y, in lengths per unit of "
           "delay")
      .unit("length")
      .only_of("delays by method = mc");
  keys.add("shear", values.shear, "Velocity gradient: increase of v_x per unit of depth")
      .only_of("delays by method = mc");
}

double stokes_einstein(double temperature, double viscosity, double radius) {
  return boltzmann_constant * temperature / (6 * std::numbers::pi * viscosity * radius);
}

namespace {

const KeyUnit no_unit, seconds("s"), diffusion_unit("m^2/s");

bool is_plain(const std::string& text) {
  return written_number(text, no_unit).has_value();
}

/// Returns the diffusion constant in m^2/s that the keys give; nullopt if they give none.
std::optional<double> diffusion_constant(const Keys& keys, const DynamicsValues& values,
                                         const SceneSpec& spec,
                                         const std::optional<double>& metres) {
  const auto& text = keys.read(values.diffusion);
  const auto require_unit = [&](const std::string& key, const std::string& value) {
    if (!metres)
      throw InputError(key, value,
                       "requires length_unit, such as length_unit = um, the unit of the "
                       "wavelength");
  };
  if (keys.read(values.temperature)) {
    const std::string value = number_text(*values.temperature);
    if (text) throw InputError("diffusion, temperature: give only one of them");
    require_unit("temperature", value);
    if (!keys.read(values.viscosity))
      throw InputError("temperature", value,
                       "requires viscosity, such as viscosity = \"0.954 mPa s\", that of water at "
                       "295.15 K (22 degrees Celsius)");
    std::optional<double> radius = spec.diameter ? *spec.diameter / 2 : spec.radius;
    if (values.particle_radius) radius = keys.read(values.particle_radius);
    if (!radius)
      throw InputError("temperature", value,
                       "requires particle_radius for scatterers without a radius");
    return stokes_einstein(*values.temperature, *values.viscosity, *radius * *metres);
  }
  if (!text || is_plain(*text)) return std::nullopt;
  const auto diffusion = written_number(*text, diffusion_unit);
  if (!diffusion)
    throw InputError("diffusion", *text,
                     "must be a diffusion constant such as 4.3e-13 m^2/s, or a number (k^2 D per "
                     "unit of delay)");
  require_unit("diffusion", *text);
  return diffusion;
}

std::vector<double> times(const std::string& key, const std::vector<std::string>& texts,
                          bool in_seconds) {
  std::vector<double> all;
  for (const std::string& text : texts) {
    std::vector<double> some;
    try {
      some = written_numbers(key, text, in_seconds ? seconds : no_unit);
    } catch (const InputError&) {
      if (in_seconds || written_numbers(key, text, seconds).empty()) throw;
      throw InputError(key, text,
                       "has a unit of time: also give diffusion in m^2/s, or temperature and "
                       "viscosity");
    }
    all.insert(all.end(), some.begin(), some.end());
  }
  for (const double time : all)
    if (!(time >= 0 && time <= 1e100))
      throw InputError(key, time, "must not be negative, and at most 1e100");
  return all;
}

}  // namespace

Dynamics make_dynamics(const Keys& keys, const DynamicsValues& values, const SceneSpec& spec,
                       const std::optional<double>& metres) {
  Dynamics dynamics;
  if (keys.read(values.delays).empty()) return dynamics;
  dynamics.diffusion = diffusion_constant(keys, values, spec, metres);
  const bool in_seconds = dynamics.diffusion.has_value();
  dynamics.delays = times("delays", values.delays, in_seconds);
  if (const auto& text = values.diffusion; text && !in_seconds)
    dynamics.motion.diffusion = *written_number(*text, no_unit);
  if (in_seconds) {
    const double k = 2 * std::numbers::pi / (spec.inside_wavelength() * *metres);
    dynamics.motion.diffusion = k * k * *dynamics.diffusion;
  }
  if (!(dynamics.motion.diffusion >= 0 && dynamics.motion.diffusion <= 1e100))
    throw InputError("diffusion", values.diffusion.value_or(""), "must not be negative");
  if (const auto& velocity = keys.read(values.velocity); !velocity.empty()) {
    const bool three = velocity.size() == 3 && spec.dimension == 3;
    if (velocity.size() != 2 && !three)
      throw InputError("velocity", std::to_string(velocity.size()) + " numbers",
                       "must be v_x, v_z or, with dimension = 3, v_x, v_z, v_y");
    dynamics.motion.velocity = {velocity[0], velocity[1], three ? velocity[2] : 0};
  }
  dynamics.motion.shear = keys.read(values.shear).value_or(0);
  dynamics.exposure.times = times("exposures", keys.read(values.exposures), in_seconds);
  for (const double time : dynamics.exposure.times)
    if (time == 0) throw InputError("exposures", time, "must be positive");
  if (spec.covariance == "intensity") dynamics.exposure.beta = keys.read(values.beta);
  return dynamics;
}

}  // namespace flatspeckle::mc
