#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/keys/keys.h"
#include "grin/media/geometry/shapes.h"

namespace flatspeckle::grin {

// Places, directions and shapes as keys have them, whose rows have checked how many numbers there
// are. What cannot be used throws InputError naming the key.

/// The row of three numbers.
Key& add_vector(Keys& keys, const std::string& name, std::vector<double>& member,
                const std::string& help);
/// Those from `first` on.
Vec3 vector_of(std::span<const double> values, std::size_t first = 0);
/// The value of a key as a direction.
Vec3 direction_of(const Keys& keys, const std::vector<double>& member);

/// The numbers of a key that takes so many for each thing.
std::vector<std::span<const double>> parts_of(const std::vector<double>& values, std::size_t size);
/// Of x y z radius, one for each four.
std::vector<Sphere> spheres_of(const Keys& keys, const std::vector<double>& member);
/// Of two opposite corners, one for each six numbers.
std::vector<Box> boxes_of(const Keys& keys, const std::vector<double>& member);

/// Made of length 1. Throws InputError where it has none.
Vec3 unit_direction(const std::string& key, const Vec3& direction);
/// As the rows of keys that must be positive: from 1e-50 to 1e50. Throws InputError.
double positive(const std::string& key, double value);

/// "1 2 3", for messages.
std::string listed(const Vec3& x);

}  // namespace flatspeckle::grin
