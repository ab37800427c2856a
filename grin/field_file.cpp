#include "grin/field_file.h"

#include "core/error.h"
#include "core/result_reader.h"

namespace flatspeckle::grin {

namespace {

Vec3 read_vector(const ResultReader& file, const std::string& name) {
  const auto values = file.attribute<std::vector<double>>("excess", name);
  if (values.size() != 3) throw InputError("numbers in " + name, values.size(), "must be 3");
  return {values[0], values[1], values[2]};
}

SplineField read(const ResultReader& file) {
  const std::vector<std::size_t> shape = file.shape("excess");
  if (shape.size() != 3) throw InputError("axes of excess", shape.size(), "must be 3: x, y, z");
  FieldGrid grid{read_vector(file, "origin"), read_vector(file, "spacing"), {}};
  for (int a = 0; a < 3; ++a) grid.nodes[a] = static_cast<int>(shape[a]);
  return SplineField(grid, file.dataset<double>("excess"));
}

}  // namespace

SplineField read_spline_field(const std::filesystem::path& path) {
  const ResultReader file(path);
  try {
    return read(file);
  } catch (const InputError& error) {
    const std::string message = error.what();
    if (message.find(path.string()) != std::string::npos) throw;
    throw InputError(path.string() + ": " + message);
  }
}

}  // namespace flatspeckle::grin
