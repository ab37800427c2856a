#include "tests/fuzz/input.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <iostream>
#include <unistd.h>

#include "core/error.h"

namespace flatspeckle::fuzz {

namespace fs = std::filesystem;

namespace {

fs::path place() {
  return fs::temp_directory_path() / ("flatspeckle-fuzz-" + std::to_string(::getpid()));
}

[[noreturn]] void fail(const std::string& what) {
  std::fprintf(stderr, "%s\n", what.c_str());
  std::abort();
}

}  // namespace

Folder::Folder() {
  fs::create_directory(place());
  fs::current_path(place());
  std::cout.rdbuf(nullptr);  // suppresses the program's notes
  std::cerr.rdbuf(nullptr);
}

Folder::~Folder() {
  std::error_code none;
  fs::remove_all(place(), none);
}

void write_file(const fs::path& path, std::string_view bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

bool taken(const std::string& what, void (*use)(const std::string&)) {
  try {
    use(what);
    return true;
  } catch (const InputError&) {
  } catch (const IoError&) {
  } catch (const std::exception& error) {
    fail(what + ": neither accepted nor rejected: " + error.what());
  }
  return false;
}

void require_finite(double value) {
  if (!std::isfinite(value)) fail("a number that is not finite was accepted");
}

std::string first_line(std::string_view text) {
  const std::string_view line = text.substr(0, text.find('\n'));
  return line.starts_with("# ") ? std::string(line.substr(2)) : "";
}

}  // namespace flatspeckle::fuzz
