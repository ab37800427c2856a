#pragma once

#include <vector>

#include "core/keys/keys.h"
#include "grin/space/stage.h"

namespace flatspeckle::grin {

/// Bodies whose index and medium are the same everywhere, as keys have them: as many as there are
/// rows of numbers.
struct PlainBodyValues {
  std::vector<double> ball{}, block{};
};

void add_keys(Keys& keys, PlainBodyValues& values);

/// Throws InputError for numbers out of range and a body that is not within the boundary.
std::vector<Body> make_plain_bodies(const Keys& keys, const PlainBodyValues& values,
                                    const Surface& boundary);

/// A smaller body, by its volume, lies over a larger one; of equal ones the later.
void sort_by_size(std::vector<Body>& bodies);

}  // namespace flatspeckle::grin
