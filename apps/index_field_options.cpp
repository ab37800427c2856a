#include "apps/index_field_options.h"

#include <map>
#include <set>

#include "core/error.h"

namespace flatspeckle::apps {

namespace {

constexpr const char* kinds =
    "homogeneous luneburg fisheye parabolic sech linear tanh blobs ultrasound focused_sound grid";

/// What each kind reads.
const std::map<std::string, std::set<std::string>> keys_of_kind = {
    {"homogeneous", {"index"}},
    {"luneburg", {"radius", "centre"}},
    {"fisheye", {"index", "radius", "centre"}},
    {"parabolic", {"index", "alpha", "centre"}},
    {"sech", {"index", "alpha", "centre"}},
    {"linear", {"index", "slope"}},
    {"tanh", {"index_low", "index_high", "ramp_width", "ramp_axis", "centre"}},
    {"blobs", {"index", "blobs"}},
    {"ultrasound", {"index", "amplitude", "sound_order", "sound_wavenumber", "sound_phase"}},
    {"focused_sound",
     {"index", "amplitude", "sound_wavenumber", "sound_phase", "emitters", "aperture", "focusing",
      "centre"}},
    {"grid", {"grid"}}};

/// Fields that are a medium, not something added to one.
const std::set<std::string> media = {"homogeneous", "luneburg", "fisheye", "parabolic", "sech"};

std::string only_medium(const IndexFieldSpec& spec) {
  std::string medium;
  std::set<std::string> seen;
  if (spec.kinds.empty()) throw InputError("field", "", std::string("must be of ") + kinds);
  for (const auto& kind : spec.kinds) {
    if (!keys_of_kind.contains(kind))
      throw InputError("field", kind, std::string("must be of ") + kinds);
    if (!seen.insert(kind).second) throw InputError("field", kind, "must not be there twice");
    if (!media.contains(kind)) continue;
    if (!medium.empty())
      throw InputError("field", medium + " " + kind,
                       "only one of homogeneous luneburg fisheye parabolic sech may be in a sum");
    medium = kind;
  }
  return medium;
}

std::string kinds_with(const std::string& key) {
  std::string names;
  for (const auto& [kind, keys] : keys_of_kind)
    if (keys.contains(key)) names += ' ' + kind;
  return names;
}

void refuse_unused(const Subcommand& command, const IndexFieldSpec& spec,
                   const std::string& medium) {
  std::set<std::string> all, used;
  std::string names;
  for (const auto& [kind, keys] : keys_of_kind) all.insert(keys.begin(), keys.end());
  for (const auto& kind : spec.kinds) {
    const auto& keys = keys_of_kind.at(kind);
    used.insert(keys.begin(), keys.end());
    names += (names.empty() ? "" : " ") + kind;
  }
  // In a sum it is the medium's.
  if (!medium.empty() && !keys_of_kind.at(medium).contains("index")) used.erase("index");
  for (const auto& key : all)
    if (command.given(key) && !used.contains(key))
      throw InputError(key + ": the field (" + names + ") has no use for it; it is a key of" +
                       kinds_with(key));
}

}  // namespace

std::string medium_of(const Subcommand& command, const IndexFieldSpec& spec) {
  const std::string medium = only_medium(spec);
  refuse_unused(command, spec, medium);
  return medium;
}

void add_index_field_options(Options& options, IndexFieldSpec& spec) {
  options.add("--field", spec.kinds,
              std::string("Index field, or several that add up (default homogeneous): ") + kinds);
  options.add("--index", spec.index,
              "Index of homogeneous, on the axis of parabolic and sech, in the centre of fisheye "
              "(default 2 there), at the origin of linear; else background (default 1)");
  options.add("--radius", spec.radius,
              "luneburg: of the ball; fisheye: where n is half (default 1)");
  options.add("--alpha", spec.alpha,
              "parabolic, sech: alpha of n^2 = n0^2 - alpha^2 rho^2, and "
              "of n0 sech(alpha rho); 1/length");
  options.add("--centre", spec.centre,
              "x y z of the centre of luneburg and fisheye, the axis of a guide, the middle of "
              "tanh, the focus of focused_sound (default 0 0 0)");
  options.add("--slope", spec.slope, "linear: gradient of the index, 1/length");
  options.add("--index_low", spec.index_low,
              "tanh: index far behind; in a sum the ramp adds their difference");
  options.add("--index_high", spec.index_high, "tanh: index far along the axis");
  options.add("--ramp_width", spec.ramp_width, "tanh: of tanh(distance/width) (default 1)");
  options.add("--ramp_axis", spec.ramp_axis, "tanh: direction (default 0 0 1)");
  options.add("--blobs", spec.blobs,
              "CSV with columns x, y, z, height, width: height exp(-r^2/(2 width^2))");
  options.add("--amplitude", spec.amplitude, "ultrasound, focused_sound: of the index");
  options.add("--sound_wavenumber", spec.sound_wavenumber, "2 pi frequency / speed of the sound");
  options.add("--sound_order", spec.sound_order,
              "ultrasound: m of J_m(k rho) cos(m phi) (default 0)");
  options.add("--sound_phase", spec.sound_phase,
              "Phase at which the sound is frozen, radians (default 0)");
  options.add("--emitters", spec.emitters, "focused_sound: plane waves (default 16)");
  options.add("--aperture", spec.aperture,
              "focused_sound: half angle about z, radians (default 0.5)");
  options.add("--focusing", spec.focusing,
              "focused_sound: cone (on a point, default) or arc (on a line)");
  options.add("--grid", spec.grid,
              "HDF5 with excess[x, y, z] = n - 1 and its attributes origin, spacing");
}

}  // namespace flatspeckle::apps
