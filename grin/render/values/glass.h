#pragma once

#include <string>

namespace flatspeckle::grin {

/// Returns the refractive index of a glass at a vacuum wavelength in micrometres. glass: the name
/// of a glass of the table in glass.cpp; or "nd/Vd", index and Abbe number, between which n is
/// linear in 1/wavelength^2; or "B1/B2/B3/C1/C2/C3", the coefficients of Sellmeier's formula n^2 -
/// 1 = sum_i B_i w^2 / (w^2 - C_i), with the wavelength w in micrometres. Throws InputError.
double glass_index(const std::string& key, const std::string& glass, double micrometres);

/// Returns the names of the glasses of the table.
std::string glass_names();

}  // namespace flatspeckle::grin
