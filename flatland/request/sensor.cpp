#include "flatland/request/sensor.h"

#include "core/error.h"
#include "core/keys/csv.h"

namespace flatspeckle {

std::vector<Vec2> read_points(const std::string& path) {
  const Table table = read_csv(path, {"x", "z"});
  for (const char* name : {"x", "z"})
    if (!table.has(name)) throw InputError(path + ": column " + name + " is missing");
  if (table.rows() == 0) throw InputError(path + ": holds no point, must hold at least one");
  std::vector<Vec2> points;
  for (std::size_t row = 0; row < table.rows(); ++row)
    points.push_back({table.column("x")[row], table.column("z")[row]});
  return points;
}

}  // namespace flatspeckle
