#include "grin/render/values/field_body.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <utility>

#include "core/keys/number_text.h"
#include "grin/media/geometry/vector_values.h"
#include "grin/rays/surfaces/mesh_file.h"
#include "grin/rays/surfaces/mesh_surface.h"
#include "grin/render/stage/stage.h"
#include "grin/render/values/glass.h"

namespace flatspeckle::grin {

namespace {

using Numbers = std::span<const double>;

constexpr std::size_t asphere_numbers = 13;

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
  if (const auto* lens = std::get_if<AsphericLens>(&surface)) return lens->volume();
  if (const auto* turned = std::get_if<TurnedShape>(&surface)) return turned->volume();
  const auto [low, high] = bounds(surface);
  return (high - low).prod();
}

/// Returns the rotation of each of `count` bodies: that of the key, or none.
std::vector<Vec3> rotations_of(const Keys& keys, const std::vector<double>& turns,
                               std::size_t count) {
  std::vector<Vec3> rotations(count, Vec3::Zero());
  const auto given = parts_of(keys.read(turns), 3);
  if (given.empty()) return rotations;
  if (given.size() != count)
    throw InputError(keys.name(turns), number_text(turns),
                     "requires three numbers for each of " + std::to_string(count) + " bodies");
  for (std::size_t i = 0; i < count; ++i) rotations[i] = vector_of(given[i]);
  return rotations;
}
Surface turned(const TurnedShape::Shape& shape, const Vec3& rotation) {
  if (rotation.norm() > 0) return TurnedShape(shape, rotation);
  return std::visit([](const auto& s) -> Surface { return s; }, shape);
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

/// Makes the body of a mesh. key: the name of the key that names the file.
GivenBody mesh_body(const Keys& keys, const std::string& key, const MeshValues& values,
                    const std::string& file, const Surface* stage) {
  const TriangleMesh mesh = read_mesh(key, file, keys.read(values.weld));
  const Box box = bounds(mesh);
  if (stage && !lies_in(box, *stage))
    throw InputError(key + ": from " + listed(box.low) + " to " + listed(box.high) +
                     ", must be inside of the stage");
  const std::string name = keys.name(values.spacing);
  const std::optional<double>& spacing = keys.read(values.spacing);
  constexpr double finer = 3;
  const CurvedMesh curved =
      curved_mesh(mesh, keys.read(values.crease), spacing.value_or(first_spacing(mesh)) / finer);
  try {
    const LevelSurface surface =
        spacing ? mesh_surface(curved.mesh, *spacing, name) : mesh_surface(curved, name);
    return {surface, note_on(key + " = " + file, surface, curved)};
  } catch (const OverlapError& error) {
    throw InputError(key, file, error.what());
  }
}

/// Adds the keys of a mesh's shape; their names begin with that of the key of its file.
void add_mesh_keys(Keys& keys, const std::string& file_key, MeshValues& values) {
  keys.add(file_key + "_spacing", values.spacing,
           "Spacing of the grid of distances from the mesh that defines the smooth surface; edges "
           "are rounded over one spacing (default: 1/64 of the longest side of the mesh, or less, "
           "down to 1/256, if normals would otherwise be wrong by 0.01 rad (rms), the area by 5 % "
           "or "
           "the volume by 1 %)")
      .positive()
      .unit("length")
      .only_of(file_key);
  keys.add(file_key + "_crease", values.crease,
           "Largest angle between the normals of two triangles that are taken as parts of one "
           "curved surface; edges of larger angles stay sharp; 0: all triangles are plane")
      .from(0, 1.5)
      .unit("rad")
      .only_of(file_key);
  keys.add(file_key + "_weld", values.weld,
           "Corners up to this distance apart are merged if the surface is not closed otherwise "
           "(default: 1e-5 of the size of the mesh)")
      .not_negative()
      .unit("length")
      .only_of(file_key);
}

std::vector<Body> make_mesh_bodies(const Keys& keys, const PlainBodyValues& values) {
  std::vector<Body> bodies;
  const auto& files = keys.read(values.mesh);
  if (files.empty()) return bodies;
  const auto materials = parts_of(keys.required(values.mesh_material), 4);
  if (materials.size() != files.size())
    throw InputError("mesh_material", number_text(values.mesh_material),
                     "requires index mu_s mu_a g for each mesh");
  for (std::size_t i = 0; i < files.size(); ++i) {
    const auto [surface, note] =
        mesh_body(keys, keys.name(values.mesh), values.mesh_shape, files[i], nullptr);
    bodies.push_back(body_of("mesh_material, ", surface, materials[i]));
    bodies.back().note = note;
  }
  return bodies;
}

std::vector<Body> make_aspheres(const Keys& keys, const PlainBodyValues& values) {
  const auto rows = parts_of(keys.read(values.asphere), asphere_numbers);
  const auto& terms = keys.read(values.asphere_terms);
  constexpr std::size_t terms_each = 6;
  if (!terms.empty() && terms.size() != terms_each * rows.size())
    throw InputError("asphere_terms: requires six coefficients for each asphere");
  const auto rotations = rotations_of(keys, values.asphere_turns, rows.size());
  std::vector<Body> bodies;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Numbers row = rows[i];
    const auto face = [&](std::size_t at) {
      const double radius = row[4 + 2 * at];
      AsphericFace shape{radius == 0 ? 0 : 1 / radius, row[5 + 2 * at]};
      for (std::size_t k = 0; k < 3 && !terms.empty(); ++k)
        shape.terms[k] = terms[terms_each * i + 3 * at + k];
      return shape;
    };
    const auto lens = AsphericLens::make(vector_of(row), positive("asphere, radius", row[3]),
                                         face(0), face(1), positive("asphere, thickness", row[8]));
    if (!lens)
      throw InputError("asphere", number_text({row.begin(), row.begin() + 9}),
                       "faces must extend to the radius and must not meet within it");
    bodies.push_back(body_of("asphere, ", turned(*lens, rotations[i]), row.subspan(9)));
  }
  return bodies;
}

std::vector<Body> make_blocks(const Keys& keys, const PlainBodyValues& values) {
  const auto rows = parts_of(keys.read(values.block), 10);
  const auto rotations = rotations_of(keys, values.block_turns, rows.size());
  std::vector<Body> bodies;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Box box{vector_of(rows[i]), vector_of(rows[i], 3)};
    if (!((box.high - box.low).minCoeff() > 0))
      throw InputError("block", number_text({rows[i].begin(), rows[i].begin() + 6}),
                       "must have its low corner first");
    bodies.push_back(body_of("block, ", turned(box, rotations[i]), rows[i].subspan(6)));
  }
  return bodies;
}

std::vector<Body> make_cylinders(const Keys& keys, const PlainBodyValues& values) {
  std::vector<Body> bodies;
  for (const Numbers row : parts_of(keys.read(values.cylinder), 11)) {
    const Vec3 from = vector_of(row), to = vector_of(row, 3);
    if (!((to - from).norm() > 0))
      throw InputError("cylinder", number_text({row.begin(), row.begin() + 6}),
                       "must have two different ends");
    const double radius = positive("cylinder, radius", row[6]);
    bodies.push_back(
        body_of("cylinder, ", TurnedShape::cylinder(from, to, radius), row.subspan(7)));
  }
  return bodies;
}

std::vector<Body> make_lenses(const Keys& keys, const PlainBodyValues& values) {
  const auto rows = parts_of(keys.read(values.lens), lens_numbers + 4);
  const auto rotations = rotations_of(keys, values.lens_turns, rows.size());
  std::vector<Body> bodies;
  for (std::size_t i = 0; i < rows.size(); ++i)
    bodies.push_back(body_of("lens, ", turned(lens_of("lens", rows[i]), rotations[i]),
                             rows[i].subspan(lens_numbers)));
  return bodies;
}

/// Sets the index of lenses to that of their glass at the wavelength.
void fill_with_glass(const Keys& keys, const PlainBodyValues& values,
                     const std::optional<double>& length_unit, std::vector<Body>& lenses) {
  const auto& glasses = keys.read(values.lens_glass);
  if (glasses.empty()) return;
  if (glasses.size() != lenses.size())
    throw InputError("lens_glass: requires a glass for each lens, or - for the index of the lens");
  if (!length_unit) throw InputError("lens_glass: requires length_unit, such as mm");
  constexpr double micrometres = 1e6;
  const double wavelength = keys.required(values.wavelength) * *length_unit * micrometres;
  for (std::size_t i = 0; i < lenses.size(); ++i)
    if (glasses[i] != "-")
      lenses[i].excess = glass_index(keys.name(values.lens_glass), glasses[i], wavelength) - 1;
}

/// Calls use(name of the key of a kind of body, words of their faces).
template <class Values, class Use>
void for_each_face(Values& values, const Use& use) {
  use("ball", values.ball_face);
  use("block", values.block_face);
  use("cylinder", values.cylinder_face);
  use("lens", values.lens_face);
  use("asphere", values.asphere_face);
}

/// Sets what the surfaces of bodies do. Throws InputError unless there is a word for each body.
void set_faces(const Keys& keys, const PlainBodyValues& values, std::vector<Body>& bodies) {
  for_each_face(values, [&](const std::string& kind, const std::vector<std::string>& member) {
    const auto& words = keys.read(member);
    std::size_t next = 0, count = 0;
    for (const Body& body : bodies) count += std::string(body.keys) == kind + ", ";
    if (words.empty()) return;
    if (words.size() != count)
      throw InputError(kind + "_face", words.size(), "requires a word for each " + kind);
    for (Body& body : bodies) {
      if (std::string(body.keys) != kind + ", ") continue;
      const std::string& word = words[next++];
      body.face = word == "mirror"   ? BodyFace::reflects
                  : word == "absorb" ? BodyFace::absorbs
                                     : BodyFace::refracts;
    }
  });
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
  const std::string cylinder = "x y z x y z radius index mu_s mu_a g";
  keys.add("cylinder", values.cylinder,
           cylinder +
               ": a cylinder with its own index and medium, given by the two ends of its axis")
      .each_of(11, cylinder)
      .units("length length length length length length length 1 1/length 1/length 1");
  const std::string lens = std::string(lens_words) + " index mu_s mu_a g";
  keys.add("lens", values.lens,
           lens +
               ": a lens with its own index and medium; its axis is along z, and x y z is the "
               "front " +
               "vertex; front and back are the radii of curvature of the faces, positive if the "
               "centre is at larger z, 0 for a plane")
      .each_of(lens_numbers + 4, lens)
      .units("length length length length length length length 1 1/length 1/length 1");
  const std::string asphere =
      "x y z radius front front_conic back back_conic thickness index mu_s mu_a g";
  keys.add("asphere", values.asphere,
           asphere +
               ": a lens of conicoids, as lens; conic constants are 0 for spheres, -1 for "
               "paraboloids")
      .each_of(asphere_numbers, asphere)
      .units("length length length length length 1 length 1 length 1 1/length 1/length 1");
  keys.add("asphere_terms", values.asphere_terms,
           "a4 a6 a8 of the front and a4 a6 a8 of the back of each asphere: coefficients of rho^4, "
           "rho^6 and rho^8 in z")
      .each_of(6, "a4 a6 a8 of the front, a4 a6 a8 of the back")
      .only_of("asphere");
  const auto add_turns = [&](const std::string& body, std::vector<double>& member) {
    keys.add(body + "_turns", member,
             "Rotation of each " + body +
                 " about its middle, by the length of this vector, about its direction")
        .each_of(3, "x y z")
        .unit("rad")
        .only_of(body);
  };
  add_turns("block", values.block_turns);
  add_turns("lens", values.lens_turns);
  add_turns("asphere", values.asphere_turns);
  keys.add("lens_glass", values.lens_glass,
           "Glass of each lens, which replaces its index: nd/Vd (index and Abbe number, as "
           "1.5168/64.17), six coefficients of Sellmeier B1/B2/B3/C1/C2/C3 (C in square "
           "micrometres), " +
               glass_names() + ", or - to keep the index; requires wavelength")
      .only_of("lens");
  keys.add("wavelength", values.wavelength,
           "Wavelength in vacuum, for lens_glass and, with image_plane, the Strehl ratio and the "
           "modulation transfer function")
      .positive()
      .unit("length")
      .swept();
  keys.add(
          "mesh", values.mesh,
          "STL, OBJ or PLY files: closed surfaces of triangles, each a body with its own index and "
          "medium (mesh_material); each is replaced by a smooth surface")
      .file();
  keys.add("mesh_material", values.mesh_material,
           "index mu_s mu_a g of each mesh, in the order of mesh")
      .each_of(4, "index mu_s mu_a g")
      .units("1 1/length 1/length 1")
      .only_of("mesh");
  add_mesh_keys(keys, "mesh", values.mesh_shape);
  for_each_face(values, [&](const char* body, std::vector<std::string>& words) {
    keys.add(std::string(body) + "_face", words,
             std::string("What the surface of each ") + body +
                 " does: refract (default), mirror (reflects all light) or absorb")
        .one_of({"refract", "mirror", "absorb"})
        .only_of(body);
  });
}

std::vector<Body> make_plain_bodies(const Keys& keys, const PlainBodyValues& values,
                                    const std::optional<double>& length_unit) {
  std::vector<Body> bodies = make_mesh_bodies(keys, values);
  for (const Numbers row : parts_of(keys.read(values.ball), 8))
    bodies.push_back(body_of("ball, ", Sphere{vector_of(row), positive("ball, radius", row[3])},
                             row.subspan(4)));
  std::vector<Body> lenses = make_lenses(keys, values);
  fill_with_glass(keys, values, length_unit, lenses);
  const auto add = [&](std::vector<Body> more) {
    std::ranges::move(more, std::back_inserter(bodies));
  };
  add(make_blocks(keys, values));
  add(std::move(lenses));
  add(make_aspheres(keys, values));
  add(make_cylinders(keys, values));
  set_faces(keys, values, bodies);
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
           "STL, OBJ or PLY file, binary or text: the index field fills only the inside of this "
           "closed surface of triangles, which is replaced by a smooth surface")
      .file();
  add_mesh_keys(keys, "body_mesh", values.body_mesh_shape);
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

std::optional<GivenBody> given_body(const Keys& keys, const FieldBodyValues& values,
                                    const Surface* stage) {
  std::vector<Surface> given;
  for (const Box& box : boxes_of(keys, values.body_box)) given.push_back(box);
  for (const Sphere& sphere : spheres_of(keys, values.body_sphere)) given.push_back(sphere);
  for (const auto numbers : parts_of(keys.read(values.body_lens), lens_numbers))
    given.push_back(lens_of(keys.name(values.body_lens), numbers));
  const std::string& file = keys.read(values.body_mesh);
  const auto body = one_surface("body", body_key_names, given);
  if (file.empty()) return body ? std::optional(GivenBody{*body}) : std::nullopt;
  if (body) throw InputError(std::string(body_key_names) + ": give one body");
  return mesh_body(keys, keys.name(values.body_mesh), values.body_mesh_shape, file, stage);
}

IndexRange check_field(const SceneField& field, const Surface& region, const std::string& name) {
  if (field.grid && !lies_in(region, *field.grid))
    throw InputError("grid: must cover all of the " + name +
                     ": light needs a field everywhere in it; or give body_box = " +
                     listed(field.grid->low) + ' ' + listed(field.grid->high));
  return index_range(field, region, name);
}

void check_rim(const SceneField& field, const Surface& body) {
  if (field.rim && !lies_in(body, *field.rim))
    throw InputError("body: must be inside of the rim of luneburg");
}

}  // namespace flatspeckle::grin
