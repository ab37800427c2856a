#pragma once

#include <initializer_list>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "core/keys/keys.h"
#include "core/keys/written_number.h"

namespace flatspeckle::apps {

/// Values of an axis, as text that reads back as the same numbers: a list of them, or a range,
/// whose values are made when they are asked for, since they may be very many.
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
  /// nullptr: a list.
  const NumberRange* range() const { return std::get_if<NumberRange>(&values_); }

 private:
  std::variant<std::vector<std::string>, NumberRange> values_;
};

/// A key that a sweep varies, and its values.
struct SweepAxis {
  std::string key;
  AxisValues values;
};

/// The points of a sweep: the product of its axes, last axis fastest, or the rows of a list.
struct SweepPoints {
  std::vector<SweepAxis> axes;  ///< in the order of the result; of a list a value for each row
  bool is_list = false;

  std::size_t count() const;
  std::string value(std::size_t axis, std::size_t point) const;
  /// "g=0.5_albedo=1": a name for files.
  std::string name(std::size_t point) const;
};

/// Lists of values as given on the command line, by key, and a table of points.
struct SweepLists {
  std::vector<std::string> keys;  ///< that may be swept, in the order of the result's axes
  std::map<std::string, std::vector<double>> numbers;
  std::map<std::string, std::vector<std::string>> texts;  ///< complex numbers
  std::string points;
};
/// Puts lists in the place of the keys that may be swept.
void add_sweep_keys(Keys& keys, SweepLists& lists);

/// Throws InputError for a table without rows, with columns that are no keys of a sweep or lists
/// beside it, and for a point that comes twice.
SweepPoints sweep_points(const Keys& keys, const SweepLists& lists);

/// What a sweep varies, as given: "key=1,2,3", "key=first:last:count", the same with ":log"; or a
/// table with a column for each key. key.0 is the first number of a key of several, key.all are all
/// of them.
struct VaryValues {
  std::vector<std::string> vary;
  std::string points;
};
void add_vary_key(Keys& keys, VaryValues& values);
/// Names the table points_table where the keys have points already.
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
