#pragma once

#include <cstddef>
#include <cstdint>

// Fuzz targets: each takes one input, and ends the process (abort, sanitizer) if the program
// neither uses the input nor rejects it.

namespace flatspeckle {

namespace fuzz {
using Target = void(const std::uint8_t* bytes, std::size_t size);
}

namespace fuzz_scene {
fuzz::Target use_input;
}
namespace fuzz_table {
fuzz::Target use_input;
}
namespace fuzz_result {
fuzz::Target use_input;
}
namespace fuzz_result_bytes {
fuzz::Target use_input;
}
namespace fuzz_grid {
fuzz::Target use_input;
}

}  // namespace flatspeckle
