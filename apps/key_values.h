#pragma once

#include <string>
#include <vector>

#include "grin/fields/vec3.h"
#include "grin/surfaces/signed_distance.h"

namespace flatspeckle::apps {

// Values of keys, checked; what cannot be used throws InputError naming key and value.

double positive(const std::string& key, double value);
std::vector<double> finite(const std::string& key, const std::vector<double>& values);
/// Three finite numbers.
grin::Vec3 vector_of(const std::string& key, const std::vector<double>& values);
/// The same, not all 0, made of length 1.
grin::Vec3 direction_of(const std::string& key, const std::vector<double>& values);
/// Those from `first` on.
grin::Vec3 three(const std::vector<double>& values, std::size_t first);
/// The numbers of a key that takes so many for each thing.
std::vector<std::vector<double>> parts_of(const std::string& key, const std::vector<double>& values,
                                          std::size_t size, const std::string& what);
/// Of x y z radius, one for each four.
std::vector<grin::Sphere> spheres_of(const std::string& key, const std::vector<double>& values);
/// Of two opposite corners, one for each six numbers.
std::vector<grin::Box> boxes_of(const std::string& key, const std::vector<double>& values);

/// "1 2 3", for messages.
std::string listed(const std::vector<double>& values);
std::string listed(const grin::Vec3& x);

}  // namespace flatspeckle::apps
