#pragma once

#include <functional>
#include <optional>
#include <vector>

namespace flatspeckle {

/// A place in the unit cube.
using UnitPlace = std::vector<double>;

/// Looks for a maximum of `value` near `start` in the unit cube without derivatives (NLopt: BOBYQA
/// of Powell 2009, a quadratic model in a region of trust; of one number, the simplex of Nelder and
/// Mead). Steps begin with `first` and end with `last`. It ends early after `most` values, or where
/// there is none. What `value` throws is thrown again here.
void local_search(const UnitPlace& start, double first, double last, int most,
                  const std::function<std::optional<double>(const UnitPlace&)>& value);

}  // namespace flatspeckle
