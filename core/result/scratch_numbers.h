#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>

namespace flatspeckle {

/// Whole numbers by their index, 0 where none was set, in a file without a name that ends with the
/// process: very many take no memory. For one thread at a time.
class ScratchNumbers {
 public:
  /// Throws IoError, as set() and at().
  ScratchNumbers();

  void set(std::size_t index, std::uint64_t value);
  std::uint64_t at(std::size_t index) const;

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> file_;
};

}  // namespace flatspeckle
