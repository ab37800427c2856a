#pragma once

namespace flatspeckle::apps {

inline constexpr double light_speed = 299'792'458;  ///< m/s

}  // namespace flatspeckle::apps
