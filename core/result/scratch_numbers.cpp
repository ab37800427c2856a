#include "core/result/scratch_numbers.h"

#include <cerrno>
#include <cstring>
#include <string>
#include <unistd.h>

#include "core/error.h"

namespace flatspeckle {

namespace {

off_t place_of(std::size_t index) {
  return static_cast<off_t>(index * sizeof(std::uint64_t));
}

[[noreturn]] void fail() {
  throw IoError(std::string("a temporary file failed: ") + std::strerror(errno));
}

}  // namespace

ScratchNumbers::ScratchNumbers() : file_(std::tmpfile()) {
  if (!file_) fail();
}

void ScratchNumbers::set(std::size_t index, std::uint64_t value) {
  if (pwrite(fileno(file_.get()), &value, sizeof value, place_of(index)) != sizeof value) fail();
}

std::uint64_t ScratchNumbers::at(std::size_t index) const {
  std::uint64_t value = 0;  // behind the end, too
  if (pread(fileno(file_.get()), &value, sizeof value, place_of(index)) < 0) fail();
  return value;
}

}  // namespace flatspeckle
