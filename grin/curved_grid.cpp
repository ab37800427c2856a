#include "grin/curved_space_of.h"

namespace flatspeckle::grin {

template class CurvedSpaceOf<SplineField>;

}  // namespace flatspeckle::grin
