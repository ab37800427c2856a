#pragma once

// Helpers for the code that reads and writes result files. Only this header includes the header of
// HDF5.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <new>
#include <span>
#include <string>
#include <type_traits>
#include <utility>

#include <hdf5.h>

#include "core/numbers/address_space.h"
#include "core/numbers/complex.h"

namespace flatspeckle {

/// Owner of an HDF5 identifier, which the destructor closes.
class Hdf5Handle {
 public:
  using Closer = herr_t (*)(hid_t);
  Hdf5Handle(hid_t id, Closer close) : id_(id), close_(close) {}
  Hdf5Handle(Hdf5Handle&& other) noexcept
      : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Hdf5Handle& operator=(Hdf5Handle&&) = delete;
  ~Hdf5Handle() {
    if (id_ >= 0) close_(id_);
  }

  hid_t get() const { return id_; }

 private:
  hid_t id_;
  Closer close_;
};

/// Checks the results of HDF5 calls for one file: if a call has failed, throws an exception of type
/// Error whose message names the file.
template <typename Error>
class Hdf5Calls {
 public:
  explicit Hdf5Calls(std::string what) : what_(std::move(what)) {}

  Hdf5Handle handle(hid_t id, Hdf5Handle::Closer close) const {
    check(id);
    return {id, close};
  }

  template <typename Result>
  Result check(Result result) const {
    if (result < 0) throw Error(what_);
    return result;
  }

 private:
  std::string what_;
};

/// Throws std::bad_alloc if there is not enough memory for these bytes and HDF5 itself, because
/// HDF5 would crash.
inline void require_hdf5_memory(std::size_t bytes = 0) {
  constexpr std::size_t own = std::size_t{8} << 20;
  if (!address_space_holds(own + bytes)) throw std::bad_alloc();
}

/// Turns off the error messages that HDF5 prints in this thread. Failures are reported by
/// exceptions instead.
inline void silence_hdf5() {
  require_hdf5_memory();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

/// Returns the HDF5 type that represents a C++ type, in memory and in files.
template <typename Value>
Hdf5Handle hdf5_type() {
  hid_t type = -1;
  if constexpr (std::is_same_v<Value, Complex>) {
    type = H5Tcreate(H5T_COMPOUND, sizeof(Complex));
    H5Tinsert(type, "r", 0, H5T_NATIVE_DOUBLE);
    H5Tinsert(type, "i", sizeof(double), H5T_NATIVE_DOUBLE);
  } else if constexpr (std::is_same_v<Value, std::string>) {
    type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, H5T_VARIABLE);
    H5Tset_cset(type, H5T_CSET_UTF8);
  } else {
    static_assert(std::is_same_v<Value, double> || sizeof(Value) == 1 || sizeof(Value) == 8);
    type = H5Tcopy(std::is_same_v<Value, double> ? H5T_NATIVE_DOUBLE
                   : sizeof(Value) == 1          ? H5T_NATIVE_UINT8
                   : std::is_signed_v<Value>     ? H5T_NATIVE_INT64
                                                 : H5T_NATIVE_UINT64);
  }
  return {type, H5Tclose};
}

template <typename Number>
bool all_finite(std::span<const Number> values) {
  return std::ranges::all_of(values, [](const Number& value) {
    if constexpr (std::is_integral_v<Number>) return true;
    return std::isfinite(std::real(value)) && std::isfinite(std::imag(value));
  });
}

/// Whether `name` exists in the file. If a group in the path `name` is missing, returns false,
/// whereas H5Lexists reports a failure.
inline bool exists(hid_t file, const std::string& name) {
  for (std::size_t slash = name.find('/', 1); slash != std::string::npos;
       slash = name.find('/', slash + 1))
    if (H5Lexists(file, name.substr(0, slash).c_str(), H5P_DEFAULT) <= 0) return false;
  return name == "/" || H5Lexists(file, name.c_str(), H5P_DEFAULT) > 0;
}

}  // namespace flatspeckle
