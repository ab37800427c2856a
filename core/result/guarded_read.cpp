#include "core/result/guarded_read.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <zlib.h>

#include "core/error.h"

namespace flatspeckle {

namespace {

struct Seal {
  std::array<char, 4> word;
  std::uint32_t checksum;
  std::uint64_t length;
};
static_assert(sizeof(Seal) == 16);

Seal seal_of(const std::byte* bytes, std::size_t length) {
  const auto checksum = crc32_z(0, reinterpret_cast<const unsigned char*>(bytes), length);
  return {{'s', 'e', 'a', 'l'}, static_cast<std::uint32_t>(checksum), length};
}

/// Ends this process: by 0 if `read` returned or threw.
[[noreturn]] void read_and_exit(const std::function<void()>& read) {
  constexpr std::array signals{SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGINT, SIGTERM};
  for (const int signal : signals) std::signal(signal, SIG_DFL);
  constexpr rlimit one_minute{60, 60}, none{0, 0};
  setrlimit(RLIMIT_CPU, &one_minute);
  setrlimit(RLIMIT_CORE, &none);
  const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
  for (const int stream : {STDOUT_FILENO, STDERR_FILENO}) dup2(nowhere, stream);
  try {
    read();
  } catch (...) {
  }
  _exit(0);
}

}  // namespace

void seal(std::vector<std::byte>& bytes) {
  const Seal seal = seal_of(bytes.data(), bytes.size());
  const auto* first = reinterpret_cast<const std::byte*>(&seal);
  bytes.insert(bytes.end(), first, first + sizeof seal);
}

bool is_sealed(const std::filesystem::path& path) {
  std::error_code none;
  const auto size = std::filesystem::file_size(path, none);
  if (none || size < sizeof(Seal)) return false;
  std::vector<std::byte> bytes(size);
  std::ifstream file(path, std::ios::binary);
  if (!file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size)))
    return false;
  const std::size_t length = bytes.size() - sizeof(Seal);
  const Seal expected = seal_of(bytes.data(), length);
  return std::memcmp(&expected, bytes.data() + length, sizeof(Seal)) == 0;
}

void read_in_child(const std::filesystem::path& path, const std::function<void()>& read) {
  const pid_t child = fork();
  if (child < 0) return;  // then read it unguarded
  if (child == 0) read_and_exit(read);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    throw InputError(path.string() + ": is damaged: HDF5 comes to no end with it");
}

}  // namespace flatspeckle
