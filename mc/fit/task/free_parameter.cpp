#include "mc/fit/task/free_parameter.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/keys/written_number.h"

namespace flatspeckle::mc {

void add_motion_keys(Keys& keys, MovingSpec& spec) {
  keys.group("Motion");
  keys.add("diffusion", spec.diffusion,
           "k^2 D per unit of the delays, D the diffusion constant of the scatterers")
      .not_negative();
  keys.add("velocity_x", spec.velocity_x,
           "Velocity of the scatterers along the surface, per unit of the delays")
      .unit("length");
  keys.add("velocity_z", spec.velocity_z,
           "Velocity of the scatterers along the depth, per unit of the delays")
      .unit("length");
  keys.add("shear", spec.shear, "Shear rate: change of velocity_x per unit of depth");
  keys.add("beta", spec.beta, "K^2 (squared speckle contrast) of static scatterers").positive_to(1);
}

void add_scale_key(Keys& keys, MovingSpec& spec) {
  keys.add("detector_scale", spec.detector_scale,
           "Measured reflectance divided by that of the medium, of a detector that is not "
           "calibrated")
      .positive();
}

void add_keys(Keys& keys, MovingSpec& spec) {
  add_keys(keys, static_cast<SceneSpec&>(spec));
  add_motion_keys(keys, spec);
  add_scale_key(keys, spec);
}

namespace {

using Eigen::Index;
using Eigen::VectorXd;
using Scale = FreeParameter::Scale;

constexpr const char* form = "must be key=lower:upper, for example g=0.5:0.99";

/// Keys of positive quantities that may range over decades. Their coordinate in a fit is the
/// logarithm if the lower bound is positive.
const std::set<std::string> of_any_size = {
    "optical_depth", "mean_free_path", "density",  "volume_fraction",
    "mass_fraction", "radius",         "diameter", "depth",
    "diffusion",     "mu_s",           "mu_a",     "detector_scale"};

bool is_complex(const Key& key) {
  return key.name() == "index" || key.name() == "particle_index";
}

bool is_one_number(const Key* key) {
  return key != nullptr && !key->is_list() && !key->is_whole() &&
         (key->is_number() || is_complex(*key));
}

double number_in(const std::string& given, const std::string& text) {
  const auto number = read_number(text);
  if (!number || !std::isfinite(*number)) throw InputError("free", given, form);
  return *number;
}

/// Sets a key to a number; of a complex key only the real part is set.
void set(const Keys& keys, const std::string& name, double value) {
  const Key& key = *keys.find(name);
  if (key.is_number()) return keys.set(name, {number_text(value)});
  const std::string now = key.shown();
  const double absorbing = now.empty() ? 0 : parse_complex(name, now).imag();
  keys.set(name, {number_text(Complex(value, absorbing))});
}

std::optional<double> start_of(const Key& key) {
  if (!key.given()) return std::nullopt;
  return parse_complex(key.name(), key.shown()).real();
}

FreeParameter parsed(const std::string& text) {
  const auto equals = text.find('='), colon = text.find(':');
  if (equals == std::string::npos || colon == std::string::npos || colon < equals)
    throw InputError("free", text, form);
  FreeParameter free;
  free.key = trimmed(text.substr(0, equals));
  free.lower = number_in(text, text.substr(equals + 1, colon - equals - 1));
  free.upper = number_in(text, text.substr(colon + 1));
  if (!(free.lower < free.upper))
    throw InputError("free", text, "the lower bound must be below the upper one");
  return free;
}

void check_bounds(const FreeParameter& free, const std::string& text, const MovingSpec& scene) {
  const Keyed<MovingSpec> keyed(scene);
  if (!is_one_number(keyed.keys.find(free.key)))
    throw InputError("free", text, free.key + " must be a scene key that holds one number");
  for (const double bound : {free.lower, free.upper}) {
    set(keyed.keys, free.key, bound);
    keyed.keys.check();
  }
}

FreeParameter read_one(const std::string& text, const MovingSpec& scene) {
  FreeParameter free = parsed(text);
  check_bounds(free, text, scene);
  const Keyed<MovingSpec> keyed(scene);
  free.start = start_of(*keyed.keys.find(free.key));
  if (free.start && !(free.lower <= *free.start && *free.start <= free.upper))
    throw InputError(free.key, *free.start,
                     "the start of a fit must lie within the bounds given by free = " + text);
  if (free.key == "g") free.scale = Scale::to_one;
  if (of_any_size.contains(free.key) && free.lower > 0) free.scale = Scale::logarithmic;
  return free;
}

VectorXd coordinates_of(const std::vector<FreeParameter>& free, double FreeParameter::*value) {
  VectorXd found(static_cast<Index>(free.size()));
  for (std::size_t i = 0; i < free.size(); ++i)
    found[static_cast<Index>(i)] = free[i].coordinate(free[i].*value);
  return found;
}

}  // namespace

double FreeParameter::coordinate(double value) const {
  if (scale == Scale::linear) return value;
  return scale == Scale::logarithmic ? std::log(value) : -std::log1p(-value);
}

double FreeParameter::value(double coordinate) const {
  double found = coordinate;
  if (scale == Scale::logarithmic) found = std::exp(coordinate);
  if (scale == Scale::to_one) found = -std::expm1(-coordinate);
  return std::clamp(found, lower, upper);
}

double FreeParameter::derivative(double coordinate) const {
  if (scale == Scale::linear) return 1;
  return scale == Scale::logarithmic ? std::exp(coordinate) : std::exp(-coordinate);
}

std::vector<FreeParameter> read_free_parameters(const std::vector<std::string>& texts,
                                                const MovingSpec& scene) {
  std::vector<FreeParameter> free;
  std::set<std::string> seen;
  for (const std::string& text : texts) {
    free.push_back(read_one(text, scene));
    if (!seen.insert(free.back().key).second)
      throw InputError("free", text, free.back().key + " is given twice");
  }
  return free;
}

MovingSpec with_parameters(const MovingSpec& scene, const std::vector<FreeParameter>& free,
                           const VectorXd& coordinates) {
  Keyed<MovingSpec> keyed(scene);
  for (std::size_t i = 0; i < free.size(); ++i)
    set(keyed.keys, free[i].key, free[i].value(coordinates[static_cast<Index>(i)]));
  return keyed.values;
}

VectorXd lower_coordinates(const std::vector<FreeParameter>& free) {
  return coordinates_of(free, &FreeParameter::lower);
}

VectorXd upper_coordinates(const std::vector<FreeParameter>& free) {
  return coordinates_of(free, &FreeParameter::upper);
}

}  // namespace flatspeckle::mc
