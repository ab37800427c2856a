#include "grin/render/values/field_body.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "core/keys/number_text.h"
#include "grin/media/geometry/vector_values.h"
#include "grin/rays/surfaces/mesh_surface.h"
#include "grin/render/stage/stage.h"

namespace flatspeckle::grin {

namespace {

using Numbers = std::span<const double>;

ScatteringMedium medium_of(const std::string& keys, double mu_s, double mu_a, double g) {
  if (!(mu_s >= 0)) throw InputError(keys + "mu_s", mu_s, "must not be negative");
  if (!(mu_a >= 0)) throw InputError(keys + "mu_a", mu_a, "must not be negative");
  if (!(std::abs(g) < 1)) throw InputError(keys + "g", g, "must be between -1 and 1");
  return {.mu_s = mu_s, .mu_a = mu_a, .phase = {HgPhase{g}}};
}

/// Makes a body. material: the four numbers index, mu_s, mu_a, g.
Body body_of(const char* keys, const Surface& surface, Numbers material) {
  const std::string prefix = keys;
  return {.surface = surface,
          .medium = medium_of(prefix, material[1], material[2], material[3]),
          .excess = positive(prefix + "index", material[0]) - 1,
          .keys = keys};
}

double volume(const Surface& surface) {
  if (const auto* sphere = std::get_if<Sphere>(&surface))
    return 4 * std::numbers::pi / 3 * std::pow(sphere->radius, 3);
  if (const auto* level = std::get_if<LevelSurface>(&surface)) return level->volume();
  if (const auto* lens = std::get_if<Lens>(&surface)) return lens->volume();
  const auto [low, high] = bounds(surface);
  return (high - low).prod();
}

IndexRange index_range(const SceneField& field, const Surface& region, const std::string& name) {
  constexpr int nodes = 33;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const Box box = bounds(region);
  // the field and the region are both the same at all z
  const bool is_same_along_z =
      std::holds_alternative<Box>(region) && field.axis == Vec3::UnitZ() &&
      (field.symmetry == Symmetry::guide || field.symmetry == Symmetry::round_guide);
  IndexRange range{infinity, -infinity};
  std::visit(
      [&](const auto& medium) {
        for (int node = 0; node < nodes * nodes * nodes; node += is_same_along_z ? nodes : 1) {
          const Vec3 share = Vec3(node / nodes / nodes, node / nodes % nodes, node % nodes);
          const Vec3 x = box.low + (box.high - box.low).cwiseProduct(share) / (nodes - 1);
          if (distance(region, x) > 0) continue;
          const double n = index(medium, x);
          if (!(n > 0 && std::isfinite(n)))
            throw InputError("index at " + listed(x), n, "must be positive in all of the " + name);
          range = {std::min(range.lowest, n), std::max(range.highest, n)};
        }
      },
      field.field);
  return range;
}

LevelSurface mesh_body(const Keys& keys, const FieldBodyValues& values, const std::string& file,
                       const Surface* stage) {
  const TriangleMesh mesh = read_stl(keys.name(values.body_mesh), file);
  const Box box = bounds(mesh);
  if (stage && !lies_in(box, *stage))
    throw InputError(keys.name(values.body_mesh) + ": from " + listed(box.low) + " to " +
                     listed(box.high) + ", must be inside of the stage");
  const std::string name = keys.name(values.body_mesh_spacing);
  const std::optional<double>& spacing = keys.read(values.body_mesh_spacing);
  try {
    return spacing ? mesh_surface(mesh, *spacing, name) : mesh_surface(mesh, name);
  } catch (const OverlapError& error) {
    throw InputError(keys.name(values.body_mesh), file, error.what());
  }
}

}  // namespace

void add_keys(Keys& keys, PlainBodyValues& values) {
  keys.group("More bodies in the stage");
  const char* const ball = "x y z radius index mu_s mu_a g";
  const char* const block = "x y z x y z index mu_s mu_a g";
  keys.add("ball", values.ball,
           std::string(ball) +
               ": a ball with its own index and medium, scattering by Henyey and Greenstein's "
               "phase function; where bodies overlap, the smaller one counts")
      .each_of(8, ball)
      .units("length length length length 1 1/length 1/length 1");
  keys.add("block", values.block,
           std::string(block) +
               ": a box with its own index and medium, given by two opposite corners")
      .each_of(10, block)
      .units("length length length length length length 1 1/length 1/length 1");
  const std::string lens = std::string(lens_words) + " index mu_s mu_a g";
  keys.add("lens", values.lens,
           lens +
               ": a lens with its own index and medium; its axis is along z, and x y z is the "
               "front " +
               "vertex; front and back are the radii of curvature of the faces, positive if the "
               "centre is at larger z, 0 for a plane")
      .each_of(lens_numbers + 4, lens)
      .units("length length length length length length length 1 1/length 1/length 1");
}

std::vector<Body> make_plain_bodies(const Keys& keys, const PlainBodyValues& values) {
  std::vector<Body> bodies;
  for (const Numbers row : parts_of(keys.read(values.ball), 8))
    bodies.push_back(body_of("ball, ", Sphere{vector_of(row), positive("ball, radius", row[3])},
                             row.subspan(4)));
  for (const Numbers row : parts_of(keys.read(values.block), 10)) {
    const Box box{vector_of(row), vector_of(row, 3)};
    if (!((box.high - box.low).minCoeff() > 0))
      throw InputError("block", number_text({row.begin(), row.begin() + 6}),
                       "must have its low corner first");
    bodies.push_back(body_of("block, ", box, row.subspan(6)));
  }
  for (const Numbers row : parts_of(keys.read(values.lens), lens_numbers + 4))
    bodies.push_back(body_of("lens, ", lens_of("lens", row), row.subspan(lens_numbers)));
  return bodies;
}

void check_within(const Body& body, const Surface& region, const std::string& name) {
  const auto [low, high] = bounds(body.surface);
  if (!lies_in(body.surface, region))
    throw InputError(std::string(body.keys) + "from " + listed(low) + " to " + listed(high) +
                     ": must be inside of the " + name);
}

void sort_by_size(std::vector<Body>& bodies) {
  constexpr double rounding = 1e-12;
  std::vector<Body> sorted;
  for (const Body& body : bodies) {
    const double least = (1 - rounding) * volume(body.surface);
    const auto smaller = std::find_if(sorted.begin(), sorted.end(), [&](const Body& other) {
      return volume(other.surface) < least;
    });
    sorted.insert(smaller, body);
  }
  bodies = std::move(sorted);
}

Lens lens_of(const std::string& key, std::span<const double> numbers) {
  const double radius = positive(key + ", radius", numbers[3]);
  const double thickness = positive(key + ", thickness", numbers[6]);
  if (const auto lens = Lens::make(vector_of(numbers), radius, numbers[4], numbers[5], thickness))
    return *lens;
  throw InputError(
      key, number_text({numbers.begin(), numbers.begin() + lens_numbers}),
      "radii of curvature must not be below the radius, and the faces must not meet within it");
}

void add_body_keys(Keys& keys, FieldBodyValues& values) {
  keys.add("body_box", values.body_box,
           "x y z x y z of two corners: the index field fills only this box")
      .each_of(6, "two opposite corners, the low one first")
      .unit("length");
  keys.add("body_sphere", values.body_sphere,
           "x y z radius: the index field fills only this sphere; not needed for luneburg in a "
           "larger stage")
      .each_of(4, "centre and radius")
      .unit("length");
  keys.add(
          "body_lens", values.body_lens,
          std::string(lens_words) +
              ": the index field fills only this lens; its axis is along z, and x y z is the " +
              "front vertex; front and back are the radii of curvature of the faces, positive if " +
              "the centre is at larger z, 0 for a plane; a rod if both are 0")
      .each_of(lens_numbers, lens_words)
      .unit("length");
  keys.add("body_mesh", values.body_mesh,
           "STL file, binary or text: the index field fills only the inside of this closed surface "
           "of triangles, which is replaced by a smooth surface")
      .file();
  keys.add("body_mesh_spacing", values.body_mesh_spacing,
           "Spacing of the grid of distances from the mesh that defines the smooth surface; edges "
           "are rounded over one spacing (default: 1/64 of the longest side of the mesh, or less, "
           "down to 1/256, if the volume would be wrong by 1 % otherwise)")
      .positive()
      .unit("length")
      .only_of("body_mesh");
}

void add_index_around(Keys& keys, FieldBodyValues& values) {
  keys.add("index_around", values.index_around, "Index of refraction around the body").positive();
}

std::optional<Surface> one_surface(const std::string& name, const std::string& keys,
                                   const std::vector<Surface>& given) {
  if (given.size() > 1) throw InputError(keys + ": give one " + name);
  if (given.empty()) return std::nullopt;
  return given.front();
}

std::optional<Surface> given_body(const Keys& keys, const FieldBodyValues& values,
                                  const Surface* stage) {
  std::vector<Surface> given;
  for (const Box& box : boxes_of(keys, values.body_box)) given.push_back(box);
  for (const Sphere& sphere : spheres_of(keys, values.body_sphere)) given.push_back(sphere);
  for (const auto numbers : parts_of(keys.read(values.body_lens), lens_numbers))
    given.push_back(lens_of(keys.name(values.body_lens), numbers));
  const std::string& file = keys.read(values.body_mesh);
  const auto body = one_surface("body", body_key_names, given);
  if (file.empty()) return body;
  if (body) throw InputError(std::string(body_key_names) + ": give one body");
  return mesh_body(keys, values, file, stage);
}

IndexRange check_field(const SceneField& field, const Surface& region, const std::string& name) {
  if (field.grid && !lies_in(region, *field.grid))
    throw InputError("grid: must cover all of the " + name +
                     ": light needs a field everywhere in it");
  return index_range(field, region, name);
}

void check_rim(const SceneField& field, const Surface& body) {
  if (field.rim && !lies_in(body, *field.rim))
    throw InputError("body: must be inside of the rim of luneburg");
}

}  // namespace flatspeckle::grin
