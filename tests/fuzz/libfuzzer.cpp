#include "tests/fuzz/libfuzzer.h"

#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "tests/fuzz/input.h"
#include "tests/fuzz/targets.h"

namespace {

using namespace flatspeckle;

struct NamedTarget {
  std::string_view name;
  fuzz::Target* use;
};
constexpr NamedTarget targets[] = {{"scene", fuzz_scene::use_input},
                                   {"table", fuzz_table::use_input},
                                   {"result", fuzz_result::use_input},
                                   {"result_bytes", fuzz_result_bytes::use_input},
                                   {"grid", fuzz_grid::use_input}};

fuzz::Target* chosen = nullptr;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  constexpr std::string_view flag = "--target=";
  for (int i = 1; i < *argc; ++i)
    for (const NamedTarget& target : targets) {
      const std::string_view argument = (*argv)[i];
      if (argument.starts_with(flag) && argument.substr(flag.size()) == target.name)
        chosen = target.use;
    }
  if (!chosen) {
    std::fputs("fuzz: needs --target=scene, table, result, result_bytes or grid\n", stderr);
    std::exit(2);
  }
  static const fuzz::Folder folder;
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  chosen(bytes, size);
  return 0;
}
