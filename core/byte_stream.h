#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "core/error.h"

namespace flatspeckle {

/// Writes values as a sequence of bytes: numbers in the machine's representation, texts and lists
/// preceded by their lengths.
class ByteWriter {
 public:
  template <typename Number>
  requires std::is_trivially_copyable_v<Number>
  void put(const Number& value) {
    const auto* first = reinterpret_cast<const std::byte*>(&value);
    bytes_.insert(bytes_.end(), first, first + sizeof value);
  }
  void put(const std::string& text) {
    put(std::uint64_t{text.size()});
    const auto* first = reinterpret_cast<const std::byte*>(text.data());
    bytes_.insert(bytes_.end(), first, first + text.size());
  }
  template <typename Value>
  void put(const std::vector<Value>& values) {
    put(std::uint64_t{values.size()});
    for (const Value& value : values) put(value);
  }

  std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

/// Reads values from bytes that ByteWriter has written. Throws InputError if bytes are missing.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  template <typename Number>
  requires std::is_trivially_copyable_v<Number>
  void get(Number& value) { std::memcpy(&value, next(sizeof value).data(), sizeof value); }
  void get(std::string& text) {
    const auto part = next(get<std::uint64_t>());
    text.assign(reinterpret_cast<const char*>(part.data()), part.size());
  }
  template <typename Value>
  void get(std::vector<Value>& values) {
    values.resize(checked_count(get<std::uint64_t>()));
    for (Value& value : values) get(value);
  }
  template <typename Value>
  Value get() {
    Value value{};
    get(value);
    return value;
  }

  /// Returns a count read from the bytes. Throws InputError if it is above 2^32, which happens only
  /// if the bytes are damaged.
  static std::size_t checked_count(std::uint64_t count) {
    constexpr std::uint64_t most = std::uint64_t{1} << 32;
    if (count > most) throw InputError("a stored result is damaged: an impossible length");
    return count;
  }
  std::span<const std::byte> rest() const { return bytes_; }
  void require_end() const {
    if (!bytes_.empty()) throw InputError("a stored result is damaged: too many bytes");
  }

 private:
  std::span<const std::byte> next(std::uint64_t count) {
    if (count > bytes_.size()) throw InputError("a stored result is damaged: too few bytes");
    const auto part = bytes_.first(count);
    bytes_ = bytes_.subspan(count);
    return part;
  }

  std::span<const std::byte> bytes_;
};

}  // namespace flatspeckle
