#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/keys/keys.h"
#include "grin/media/geometry/shapes.h"

namespace flatspeckle::grin {

// Functions that read positions, directions and shapes from scene keys. The keys have already
// checked how many numbers they contain. Invalid values throw an InputError that names the key.

/// Adds a scene key whose value is a vector of three numbers.
Key& add_vector(Keys& keys, const std::string& name, std::vector<double>& member,
                const std::string& help);
/// Returns three of the values, starting at index `first`, as a vector.
Vec3 vector_of(std::span<const double> values, std::size_t first = 0);
/// Returns the vector given by a scene key, normalised to length 1.
Vec3 direction_of(const Keys& keys, const std::vector<double>& member);

/// Splits the numbers given by a scene key into groups of `size`, one group for each object.
std::vector<std::span<const double>> parts_of(const std::vector<double>& values, std::size_t size);
/// Returns one sphere for each group of four numbers x y z radius.
std::vector<Sphere> spheres_of(const Keys& keys, const std::vector<double>& member);
/// Returns one box for each group of six numbers, the coordinates of two opposite corners.
std::vector<Box> boxes_of(const Keys& keys, const std::vector<double>& member);

/// Returns the vector normalised to length 1. Throws InputError for the zero vector.
Vec3 unit_direction(const std::string& key, const Vec3& direction);
/// Returns `value`. Throws an InputError that names `key` unless the value is from 1e-50 to 1e50,
/// the range of all keys that must be positive.
double positive(const std::string& key, double value);

/// Returns the components as "1 2 3", for messages.
std::string listed(const Vec3& x);

}  // namespace flatspeckle::grin
