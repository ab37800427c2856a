#include "grin/render/values/map_values.h"

#include <algorithm>
#include <array>

#include "core/error.h"
#include "core/keys/number_text.h"
#include "grin/media/geometry/vector_values.h"

namespace flatspeckle::grin {

namespace {

constexpr double most_cells = 1 << 21;

/// Returns the numbers of cells along the axes of the map, after checking them.
template <std::size_t axes>
std::array<int, axes> map_counts(const std::vector<std::int64_t>& cells, const std::string& names) {
  double product = 1;
  for (const auto count : cells) product *= static_cast<double>(count);
  if (cells.size() != axes)
    throw InputError("map_cells", number_text(std::vector<double>(cells.begin(), cells.end())),
                     "must be counts along " + names);
  if (product > most_cells) throw InputError("map_cells", product, "must be at most 2097152 cells");
  std::array<int, axes> counts{};
  std::transform(cells.begin(), cells.end(), counts.begin(),
                 [](std::int64_t count) { return static_cast<int>(count); });
  return counts;
}

BoxCells box_cells(const Keys& keys, const MapValues& values) {
  const Box box = boxes_of(keys, values.map_box).front();
  return {box, map_counts<3>(keys.required(values.map_cells), "x, y and z")};
}

RingCells ring_cells(const Keys& keys, const MapValues& values) {
  const auto& given = keys.read(values.map_cylinder);
  const Vec3 from(given[0], given[1], given[2]), to(given[3], given[4], given[5]);
  if (!(given[6] > 0 && (to - from).norm() > 0))
    throw InputError("map_cylinder", number_text(given),
                     "must have two different end points and a positive radius");
  return {from, to, given[6], map_counts<2>(keys.required(values.map_cells), "radius and axis")};
}

/// Returns the cells. Throws InputError if they are all outside of the stage, since no light
/// reaches them there.
template <class Cells>
Cells within(const Cells& cells, const Box& stage, const std::string& key) {
  const Box box = cells.bounds();
  if (are_apart(box, stage))
    throw InputError(key + ": the map, from " + listed(box.low) + " to " + listed(box.high) +
                     ", is outside of the stage");
  return cells;
}

}  // namespace

void add_keys(Keys& keys, MapValues& values) {
  keys.group("Map of the fluence rate and of absorbed power");
  keys.add("map_box", values.map_box,
           "x y z x y z of two corners: the map divides this box into cells")
      .exactly(6, "two opposite corners, the low one first")
      .unit("length");
  keys.add("map_cylinder", values.map_cylinder,
           "x y z x y z radius: the map divides this cylinder, whose axis extends from the first "
           "point to the second, into rings")
      .exactly(7, "two points and a radius")
      .unit("length");
  keys.add("map_cells", values.map_cells,
           "Numbers of cells along x, y and z of map_box, or along the radius and the axis of "
           "map_cylinder")
      .from(1, 1 << 21)
      .only_of("a map (map_box, map_cylinder)");
}

std::optional<LightMap> light_map(const Keys& keys, const MapValues& values, const Box& stage) {
  const bool has_box = !values.map_box.empty(), has_cylinder = !values.map_cylinder.empty();
  if (has_box && has_cylinder) throw InputError("map_box, map_cylinder: give one");
  if (has_box) return within(box_cells(keys, values), stage, "map_box");
  if (has_cylinder) return within(ring_cells(keys, values), stage, "map_cylinder");
  return std::nullopt;
}

}  // namespace flatspeckle::grin
