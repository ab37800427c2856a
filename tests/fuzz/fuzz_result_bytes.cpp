#include "apps/sweep/point_journal.h"
#include "core/result/guarded_read.h"
#include "tests/fuzz/input.h"
#include "tests/fuzz/result_kinds.h"
#include "tests/fuzz/targets.h"

// Damaged HDF5 files and journals. The first byte selects the kind of file. Damaged files of
// checksummed kinds are not passed to HDF5; other kinds are first read in a child process.

namespace flatspeckle::fuzz_result_bytes {

namespace {

const char* const path = "input.h5";

void read_journal(const std::string& file) {
  std::vector<std::uint64_t> places;
  const apps::PointJournal journal(
      file, "identity", [&](const std::string&, std::uint64_t place) { places.push_back(place); });
  for (const std::uint64_t place : places) journal.read(place);
}

}  // namespace

void use_input(const std::uint8_t* input, std::size_t size) {
  fuzz::Bytes bytes(input, size);
  const auto& kinds = fuzz::result_kinds();
  const unsigned kind = bytes.below(static_cast<unsigned>(kinds.size()) + 1);
  fuzz::write_file(path, {reinterpret_cast<const char*>(input) + 1, size > 0 ? size - 1 : 0});
  if (kind == kinds.size())
    fuzz::taken(path, read_journal);
  else if (!kinds[kind].is_checksummed || is_checksummed(path))
    fuzz::taken(path, kinds[kind].read);
}

}  // namespace flatspeckle::fuzz_result_bytes
