#pragma once

namespace flatspeckle::grin {

inline constexpr double light_speed = 299'792'458;  ///< m/s

}  // namespace flatspeckle::grin
