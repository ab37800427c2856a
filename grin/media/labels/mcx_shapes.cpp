#include "grin/media/labels/mcx_shapes.h"

#include <algorithm>
#include <functional>
#include <string>

#include "core/error.h"
#include "grin/media/labels/mcx_object.h"

namespace flatspeckle::grin {

namespace {

using Contains = std::function<bool(const Vec3& middle)>;

/// Fills the voxels whose middles are in a shape. Coordinates are in voxels.
void fill(LabelVolume& volume, double tag, const Contains& contains) {
  if (!(tag >= 0 && tag < LabelVolume::most_labels && tag == std::floor(tag)))
    throw InputError("Tag", tag, "must be a whole number from 0 to 4095");
  for (int i = 0; i < volume.voxels[0]; ++i)
    for (int j = 0; j < volume.voxels[1]; ++j)
      for (int k = 0; k < volume.voxels[2]; ++k)
        if (contains(Vec3(i + 0.5, j + 0.5, k + 0.5)))
          volume.labels[volume.number(i, j, k)] = static_cast<std::uint16_t>(tag);
}

Vec3 point_of(const McxObject& shape, const std::string& key) {
  const auto numbers = shape.required(key, 3);
  return {numbers[0], numbers[1], numbers[2]};
}

void fill_box(LabelVolume& volume, const McxObject& shape, const Vec3& low, const Vec3& size) {
  fill(volume, shape.number("Tag"), [&](const Vec3& x) {
    return ((x - low).array() >= 0).all() && ((x - low - size).array() <= 0).all();
  });
}

void fill_sphere(LabelVolume& volume, const McxObject& shape) {
  shape.refuse_others({"Tag", "O", "R"});
  const Vec3 centre = point_of(shape, "O");
  const double radius = shape.number("R");
  fill(volume, shape.number("Tag"),
       [&](const Vec3& x) { return (x - centre).squaredNorm() <= radius * radius; });
}

void fill_cylinder(LabelVolume& volume, const McxObject& shape) {
  shape.refuse_others({"Tag", "C0", "C1", "R"});
  const Vec3 from = point_of(shape, "C0"), axis = point_of(shape, "C1") - from;
  const double radius = shape.number("R"), length = axis.norm();
  if (!(length > 0)) shape.refuse("C1", "must differ from C0");
  fill(volume, shape.number("Tag"), [&](const Vec3& x) {
    const double along = (x - from).dot(axis) / length;
    return along >= 0 && along <= length &&
           (x - from).squaredNorm() - along * along <= radius * radius;
  });
}

/// Fills layers [first, last, tag] of voxels, which are numbered from 1 along an axis.
void fill_layers(LabelVolume& volume, const McxObject& shapes, const std::string& key, int axis) {
  nlohmann::json layers = shapes.json()[key];
  if (layers.is_array() && !layers.empty() && layers[0].is_number())
    layers = nlohmann::json::array({layers});
  if (!layers.is_array()) shapes.refuse(key, "must be a list of layers [first, last, tag]");
  for (const auto& layer : layers) {
    const McxObject one({{key, layer}}, "Shapes");
    const auto numbers = one.required(key, 3);
    fill(volume, numbers[2],
         [&](const Vec3& x) { return x[axis] > numbers[0] - 1 && x[axis] < numbers[1]; });
  }
}

/// Fills a shape, the only member of an element of the list Shapes.
void fill_shape(LabelVolume& volume, const McxObject& element) {
  element.refuse_others(
      {"Name", "Origin", "Grid", "Box", "Sphere", "Cylinder", "XLayers", "YLayers", "ZLayers"});
  if (element.has("Origin") && element.required("Origin", 3) != std::vector<double>{0, 0, 0})
    element.refuse("Origin", "must be [0, 0, 0]");
  if (element.has("Grid")) {
    const McxObject grid = element.object("Grid");
    grid.refuse_others({"Tag", "Size"});
    fill_box(volume, grid, Vec3::Zero(), point_of(grid, "Size"));
  }
  if (element.has("Box")) {
    const McxObject box = element.object("Box");
    box.refuse_others({"Tag", "O", "Size"});
    fill_box(volume, box, point_of(box, "O"), point_of(box, "Size"));
  }
  if (element.has("Sphere")) fill_sphere(volume, element.object("Sphere"));
  if (element.has("Cylinder")) fill_cylinder(volume, element.object("Cylinder"));
  for (int axis = 0; axis < 3; ++axis) {
    const std::string key = std::string(1, static_cast<char>('X' + axis)) + "Layers";
    if (element.has(key)) fill_layers(volume, element, key, axis);
  }
}

}  // namespace

LabelVolume read_mcx_shapes(const std::filesystem::path& path) {
  const McxObject root(read_mcx(path), "");
  const McxObject domain = root.object("Domain");
  if (root.has("Shapes") && !root.json()["Shapes"].is_array())
    root.refuse("Shapes", "must be a list of shapes; write a volume to an HDF5 or NIfTI-1 file");
  if (!root.has("Shapes") && domain.has("VolumeFile"))
    domain.refuse("VolumeFile",
                  "requires keys of render instead of this scene: labels = FILE in HDF5 or NIfTI-1, "
                  "with label_media");
  const std::vector<McxObject> shapes = root.objects("Shapes");
  if (shapes.empty()) throw InputError("Shapes: is missing: labels are made of these shapes alone");
  LabelVolume volume;
  volume.spacing.setConstant(domain.number("LengthUnit", 1));
  const auto size = domain.required("Dim", 3);
  for (int axis = 0; axis < 3; ++axis) {
    constexpr double most = 1 << 20;
    if (!(size[axis] >= 1 && size[axis] <= most && size[axis] == std::floor(size[axis])))
      domain.refuse("Dim", "must be three whole numbers of at least 1");
    volume.voxels[axis] = static_cast<int>(size[axis]);
  }
  check(volume);
  volume.labels.assign(
      static_cast<std::size_t>(volume.voxels[0]) * volume.voxels[1] * volume.voxels[2], 0);
  for (const McxObject& shape : shapes) fill_shape(volume, shape);
  return volume;
}

}  // namespace flatspeckle::grin
