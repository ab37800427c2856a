#pragma once

#include <string>
#include <vector>

#include "core/keys/keys.h"
#include "grin/render/stage/stage.h"

namespace flatspeckle::grin {

/// Bodies whose index and medium are the same everywhere, as keys have them: as many as there are
/// rows of numbers.
struct PlainBodyValues {
  std::vector<double> ball{}, block{}, lens{};
};

void add_keys(Keys& keys, PlainBodyValues& values);

/// Throws InputError for numbers out of range.
std::vector<Body> make_plain_bodies(const Keys& keys, const PlainBodyValues& values);
/// And for a body that is not within a region; name: of that.
void check_within(const Body& body, const Surface& region, const std::string& name);

/// A smaller body, by its volume, lies over a larger one; of equal ones the later.
void sort_by_size(std::vector<Body>& bodies);

}  // namespace flatspeckle::grin
