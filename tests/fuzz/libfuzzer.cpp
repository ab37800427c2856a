#include "tests/fuzz/libfuzzer.h"

#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "tests/fuzz/input.h"
#include "tests/fuzz/targets.h"

namespace {

using namespace flatspeckle;

struct NamedTarget {
  const char* flag;
  fuzz::Target* use;
};
constexpr NamedTarget targets[] = {{"--target=scene", fuzz_scene::use_input},
                                   {"--target=table", fuzz_table::use_input},
                                   {"--target=result", fuzz_result::use_input},
                                   {"--target=result_bytes", fuzz_result_bytes::use_input},
                                   {"--target=grid", fuzz_grid::use_input}};

fuzz::Target* chosen = nullptr;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  for (int i = 1; i < *argc; ++i)
    for (const NamedTarget& target : targets)
      if (std::string_view((*argv)[i]) == target.flag) chosen = target.use;
  if (!chosen) {
    std::fputs("fuzz: requires one of", stderr);
    for (const NamedTarget& target : targets) std::fprintf(stderr, " %s", target.flag);
    std::fputs("\n", stderr);
    std::exit(2);
  }
  static const fuzz::Folder folder;
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  chosen(bytes, size);
  return 0;
}
