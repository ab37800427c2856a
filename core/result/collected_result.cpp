#include "core/result/collected_result.h"

#include <algorithm>
#include <functional>
#include <stdexcept>

#include "core/byte_stream.h"

namespace flatspeckle {

namespace {

/// Whether an attribute is a scalar number. Such attributes differ between the points of a sweep,
/// and are therefore stored with the values, not with the layout.
bool is_value(const Attribute& attribute) {
  constexpr std::size_t numbers = 4;  // bool, int64, uint64, double
  return attribute.index() < numbers;
}

template <typename Variant>
void put_variant(ByteWriter& bytes, const Variant& value) {
  std::visit([&](const auto& held) { bytes.put(held); }, value);
}

/// Returns a variant that holds the alternative of this index, with its default value.
template <typename Variant, std::size_t... number>
Variant of_index(std::size_t index, std::index_sequence<number...>) {
  Variant made;
  if (!((index == number && (made.template emplace<number>(), true)) || ...))
    throw InputError("a stored result is damaged: values of an unknown kind");
  return made;
}
template <typename Variant>
Variant of_index(std::size_t index) {
  return of_index<Variant>(index, std::make_index_sequence<std::variant_size_v<Variant>>());
}

template <typename Variant>
void get_variant(ByteReader& bytes, Variant& value) {
  std::visit([&](auto& held) { bytes.get(held); }, value);
}

void put_layout(ByteWriter& bytes, const CollectedDataset& set) {
  bytes.put(set.name);
  bytes.put(set.is_scale);
  bytes.put(std::uint64_t{set.axes.size()});
  for (const Axis& axis : set.axes) {
    bytes.put(std::uint64_t{axis.index()});
    put_variant(bytes, axis);
  }
  bytes.put(set.units);
  bytes.put(set.long_name);
  bytes.put(std::uint64_t{set.values.index()});
  bytes.put(std::uint64_t{set.count()});
}

CollectedDataset dataset_of(ByteReader& bytes) {
  CollectedDataset set;
  bytes.get(set.name);
  bytes.get(set.is_scale);
  for (auto axes = bytes.get<std::uint64_t>(); axes > 0; --axes) {
    set.axes.push_back(of_index<Axis>(bytes.get<std::uint64_t>()));
    get_variant(bytes, set.axes.back());
  }
  bytes.get(set.units);
  bytes.get(set.long_name);
  set.values = of_index<CollectedDataset::Held>(bytes.get<std::uint64_t>());
  const auto count = bytes.checked_count(bytes.get<std::uint64_t>());
  std::visit([&](auto& held) { held.resize(count); }, set.values);
  return set;
}

void put_layout(ByteWriter& bytes, const CollectedAttribute& attribute) {
  bytes.put(attribute.object);
  bytes.put(attribute.name);
  bytes.put(std::uint64_t{attribute.value.index()});
  if (!is_value(attribute.value)) put_variant(bytes, attribute.value);
}

CollectedAttribute attribute_of(ByteReader& bytes) {
  CollectedAttribute attribute;
  bytes.get(attribute.object);
  bytes.get(attribute.name);
  attribute.value = of_index<Attribute>(bytes.get<std::uint64_t>());
  if (!is_value(attribute.value)) get_variant(bytes, attribute.value);
  return attribute;
}

}  // namespace

std::size_t CollectedDataset::count() const {
  return std::visit([](const auto& held) { return held.size(); }, values);
}

const CollectedDataset* CollectedResult::find(const std::string& name) const {
  const auto found = std::ranges::find(datasets, name, &CollectedDataset::name);
  return found == datasets.end() ? nullptr : &*found;
}

void CollectedResult::add(CollectedDataset set) {
  if (find(set.name) != nullptr) throw std::logic_error(set.name + ": written twice");
  datasets.push_back(std::move(set));
}

void CollectedResult::begin(CollectedDataset set) {
  std::size_t count = 1;
  for (const std::size_t extent : extents(set)) count *= extent;
  std::visit([&](auto& held) { held.resize(count); }, set.values);
  add(std::move(set));
}

std::vector<std::size_t> CollectedResult::extents(const CollectedDataset& set) const {
  if (set.is_scale) return {set.count()};
  std::vector<std::size_t> extents;
  for (const Axis& axis : set.axes) {
    const auto* const plain = std::get_if<std::size_t>(&axis);
    extents.push_back(plain != nullptr ? *plain : find(std::get<std::string>(axis))->count());
  }
  return extents;
}

void CollectedResult::put_block(const std::string& name, const Values& values,
                                std::vector<std::size_t> start, std::vector<std::size_t> count) {
  auto& set = *std::ranges::find(datasets, name, &CollectedDataset::name);
  const auto extent = extents(set);
  start.resize(extent.size());
  for (std::size_t axis = count.size(); axis < extent.size(); ++axis) count.push_back(extent[axis]);
  const auto place_of = [&](std::size_t i) {
    std::size_t place = 0, stride = 1;
    for (std::size_t axis = extent.size(); axis-- > 0; stride *= extent[axis]) {
      place += (start[axis] + i % count[axis]) * stride;
      i /= count[axis];
    }
    return place;
  };
  std::visit(
      [&]<typename Value>(std::span<const Value> given) {
        auto& held = std::get<std::vector<Value>>(set.values);
        for (std::size_t i = 0; i < given.size(); ++i) held[place_of(i)] = given[i];
      },
      values);
}

bool CollectedResult::has_group(const std::string& name) const {
  return std::ranges::any_of(datasets, [group = name + '/'](const CollectedDataset& set) {
    return set.name.starts_with(group);
  });
}

bool CollectedResult::keeps_invariants() const {
  return std::ranges::all_of(datasets, [this](const CollectedDataset& set) {
    const CollectedDataset* const limit = find(set.name + "_limit");
    const bool is_invariant = set.name.find("invariants/") != std::string::npos;
    return !is_invariant || limit == nullptr ||
           std::ranges::equal(std::get<std::vector<double>>(set.values),
                              std::get<std::vector<double>>(limit->values), std::less_equal());
  });
}

void put(ResultFile& file, const CollectedResult& result) {
  for (const CollectedDataset& set : result.datasets) {
    if (set.is_scale)
      file.scale(set.name, std::get<std::vector<double>>(set.values), set.units, set.long_name);
    else
      std::visit(
          [&]<typename Value>(const std::vector<Value>& held) {
            file.dataset(set.name, std::span<const Value>(held), set.axes, set.units,
                         set.long_name);
          },
          set.values);
  }
  for (const auto& [object, name, value] : result.attributes) file.attribute(object, name, value);
}

std::vector<std::byte> layout_of(const CollectedResult& result) {
  ByteWriter bytes;
  bytes.put(std::uint64_t{result.datasets.size()});
  for (const CollectedDataset& set : result.datasets) put_layout(bytes, set);
  bytes.put(std::uint64_t{result.attributes.size()});
  for (const CollectedAttribute& attribute : result.attributes) put_layout(bytes, attribute);
  return bytes.take();
}

std::vector<std::byte> values_of(const CollectedResult& result) {
  ByteWriter bytes;
  for (const CollectedDataset& set : result.datasets)
    std::visit(
        [&](const auto& held) {
          for (const auto& value : held) bytes.put(value);
        },
        set.values);
  for (const CollectedAttribute& attribute : result.attributes)
    if (is_value(attribute.value)) put_variant(bytes, attribute.value);
  return bytes.take();
}

CollectedResult result_of(std::span<const std::byte> layout) {
  ByteReader bytes(layout);
  CollectedResult result;
  for (auto sets = bytes.get<std::uint64_t>(); sets > 0; --sets)
    result.datasets.push_back(dataset_of(bytes));
  for (auto attributes = bytes.get<std::uint64_t>(); attributes > 0; --attributes)
    result.attributes.push_back(attribute_of(bytes));
  bytes.require_end();
  return result;
}

CollectedResult result_of(std::span<const std::byte> layout, std::span<const std::byte> values) {
  CollectedResult result = result_of(layout);
  ByteReader bytes(values);
  for (CollectedDataset& set : result.datasets)
    std::visit(
        [&](auto& held) {
          for (auto& value : held) bytes.get(value);
        },
        set.values);
  for (CollectedAttribute& attribute : result.attributes)
    if (is_value(attribute.value)) get_variant(bytes, attribute.value);
  bytes.require_end();
  return result;
}

}  // namespace flatspeckle
