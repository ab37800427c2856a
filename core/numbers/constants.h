#pragma once

namespace flatspeckle {

inline constexpr double light_speed = 299'792'458;           ///< in vacuum, m/s (exact)
inline constexpr double boltzmann_constant = 1.380'649e-23;  ///< J/K (exact)
inline constexpr double planck_constant = 6.626'070'15e-34;  ///< J s (exact)

}  // namespace flatspeckle
