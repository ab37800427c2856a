#pragma once

#include <string>
#include <vector>

namespace flatspeckle::apps {

/// Fits of the same measurements by other media side by side, likeliest first: chi^2, how likely so
/// much of it is, and Akaike's weights of the media, exp(-chi^2 / 2 - parameters) over their sum.
/// Throws InputError for what is no fit, and for fits of other measurements.
void print_comparison(const std::vector<std::string>& paths);

}  // namespace flatspeckle::apps
