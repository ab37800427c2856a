#include "grin/render/values/plain_bodies.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/keys/number_text.h"
#include "grin/media/geometry/vector_values.h"
#include "grin/render/values/field_body.h"

namespace flatspeckle::grin {

namespace {

using Numbers = std::span<const double>;

ScatteringMedium medium_of(const std::string& keys, double mu_s, double mu_a, double g) {
  if (!(mu_s >= 0)) throw InputError(keys + "mu_s", mu_s, "must not be negative");
  if (!(mu_a >= 0)) throw InputError(keys + "mu_a", mu_a, "must not be negative");
  if (!(std::abs(g) < 1)) throw InputError(keys + "g", g, "must be between -1 and 1");
  return {.mu_s = mu_s, .mu_a = mu_a, .phase = {HgPhase{g}}};
}

/// material: index mu_s mu_a g.
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
  const auto [low, high] = bounds(surface);
  return (high - low).prod();
}

}  // namespace

void add_keys(Keys& keys, PlainBodyValues& values) {
  keys.group("More bodies in the stage");
  const char* const ball = "x y z radius index mu_s mu_a g";
  const char* const block = "x y z x y z index mu_s mu_a g";
  keys.add("ball", values.ball,
           std::string(ball) +
               ": a ball with its own index and medium, g of Henyey and Greenstein; bodies may lie "
               "in each other: where they overlap the smaller one is")
      .each_of(8, ball);
  keys.add("block", values.block, std::string(block) + ": the same between two corners")
      .each_of(10, block);
  const std::string lens = std::string(lens_words) + " index mu_s mu_a g";
  keys.add("lens", values.lens,
           lens + ": the same with a lens about an axis along z: front vertex, radius, radii of " +
               "curvature, positive where the centre is at larger z; 0: plane")
      .each_of(lens_numbers + 4, lens);
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
  std::stable_sort(bodies.begin(), bodies.end(), [](const Body& a, const Body& b) {
    return volume(a.surface) > volume(b.surface);
  });
}

}  // namespace flatspeckle::grin
