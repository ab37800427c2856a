#pragma once

#include <string>
#include <vector>

#include "apps/sweep/sweep_points.h"

namespace flatspeckle::apps {

/// What a sweep varies, as given: "key=1,2,3", "key=first:last:count", the same with ":log"; or a
/// table with a column for each key. key.0 is the first number of a key of several, key.all are all
/// of them.
struct VaryValues {
  std::vector<std::string> vary;
  std::string points;
};
void add_vary_key(Keys& keys, VaryValues& values);
void add_keys(Keys& keys, VaryValues& values);

/// Points of keys of `of`. Throws InputError for what is no such list or range, for keys that there
/// are not or that change no result, and for values that come twice.
SweepPoints varied_points(const Keys& keys, const VaryValues& values, const Keys& of);

/// The row of a key that can be varied, by itself or as key.0; text: what asked for it. Throws
/// InputError.
const Key& varied_key(const Keys& of, const std::string& name, const std::string& text);

/// "key=1,2,3" and the like. Throws InputError.
SweepAxis varied_axis(const Keys& of, const std::string& text);

/// Sets the keys of a point. Throws InputError.
void set_point(const SweepPoints& points, std::size_t point, const Keys& keys);

/// The key that an axis sets, without the number of a component.
std::string key_of(const SweepAxis& axis);
/// Its name as a dataset: "sensor_at_0".
std::string axis_name(const SweepAxis& axis);

}  // namespace flatspeckle::apps
