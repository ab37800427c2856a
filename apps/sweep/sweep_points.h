#pragma once

#include <initializer_list>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "core/keys/keys.h"
#include "core/keys/written_number.h"

namespace flatspeckle::apps {

/// Values along an axis of a sweep, as texts that are parsed as exactly the same numbers: a list,
/// or a range, whose values are computed when they are needed because there may be very many.
class AxisValues {
 public:
  AxisValues(std::vector<std::string> texts = {}) : values_(std::move(texts)) {}
  AxisValues(std::initializer_list<std::string> texts) : values_(std::vector(texts)) {}
  explicit AxisValues(const NumberRange& range) : values_(range) {}

  std::size_t size() const;
  std::string operator[](std::size_t number) const;
  std::string front() const { return (*this)[0]; }
  std::string back() const { return (*this)[size() - 1]; }
  std::vector<std::string> texts() const;
  /// Returns the range; nullptr if the values are a list.
  const NumberRange* range() const { return std::get_if<NumberRange>(&values_); }

 private:
  std::variant<std::vector<std::string>, NumberRange> values_;
};

/// An axis of a sweep: the swept key and its values.
struct SweepAxis {
  std::string key;
  AxisValues values;
};

/// The points of a sweep: all combinations of the values of its axes (last axis fastest), or the
/// rows of a list.
struct SweepPoints {
  /// Axes in the order of the result. For a list, each axis has one value per row.
  std::vector<SweepAxis> axes;
  bool is_list = false;

  std::size_t count() const;
  std::string value(std::size_t axis, std::size_t point) const;
  /// Returns a name of the point that can be used for files: "g=0.5_albedo=1".
  std::string name(std::size_t point) const;
};

/// Values to be swept: a list of values for each key, or a table of points.
struct SweepLists {
  std::vector<std::string> keys;  ///< keys that can be swept, in the order of the result's axes
  std::map<std::string, std::vector<double>> numbers;
  /// Lists of values for keys whose values are complex numbers.
  std::map<std::string, std::vector<std::string>> texts;
  std::string points;
};
/// Replaces each key that can be swept by a key of the same name that takes a list of values.
void add_sweep_keys(Keys& keys, SweepLists& lists);

/// Returns the points that the lists or the table define. Throws InputError for a table without
/// rows, for columns that are not keys that can be swept or that are also given as lists, and for
/// repeated points.
SweepPoints sweep_points(const Keys& keys, const SweepLists& lists);

/// Values of the keys that define a sweep. `vary` contains texts such as "key=1,2,3",
/// "key=first:last:count" or "key=first:last:count:log"; `points` names a table with a column for
/// each key instead. For a key with several numbers, key.0 stands for the first number, and key.all
/// for all of them together.
struct VaryValues {
  std::vector<std::string> vary;
  std::string points;
};
void add_vary_key(Keys& keys, VaryValues& values);
/// Adds the keys `vary` and `points`; the latter is named points_table if the subcommand has its
/// own key `points`.
void add_keys(Keys& keys, VaryValues& values);

/// Returns the points that `values` defines. of: keys of the swept subcommand. Throws InputError
/// for invalid lists or ranges, for keys that do not exist or do not change the result, and for
/// repeated values.
SweepPoints varied_points(const Keys& keys, const VaryValues& values, const Keys& of);

/// Returns the definition of the key that `name` (key or key.0) refers to. text: text that the user
/// has given, for messages. Throws InputError if the key does not exist or cannot be varied.
const Key& varied_key(const Keys& of, const std::string& name, const std::string& text);

/// Parses the text of one axis, such as "key=1,2,3" or "key=first:last:count". Throws InputError.
SweepAxis varied_axis(const Keys& of, const std::string& text);

/// Sets the keys to their values at a point. Throws InputError.
void set_point(const SweepPoints& points, std::size_t point, const Keys& keys);

/// Returns the name of the key that varies along an axis, without the number of its component:
/// "sensor_at" for sensor_at.0.
std::string key_of(const SweepAxis& axis);
/// Returns the name of the dataset of an axis: "sensor_at_0" for sensor_at.0.
std::string axis_name(const SweepAxis& axis);

}  // namespace flatspeckle::apps
