#pragma once

// Inside of the result files: the only place that knows HDF5's header.
#include <cstdint>
#include <string>
#include <type_traits>
#include <utility>

#include <hdf5.h>

#include "core/numbers/complex.h"

namespace flatspeckle {

/// An HDF5 identifier that is closed at the end of its scope.
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

/// Calls into HDF5 for one file: a failure becomes one line naming the file.
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

/// HDF5 would print a page about every failure; ours become exceptions. Holds for one thread.
inline void silence_hdf5() {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

inline Hdf5Handle complex_type() {
  const hid_t type = H5Tcreate(H5T_COMPOUND, sizeof(Complex));
  H5Tinsert(type, "r", 0, H5T_NATIVE_DOUBLE);
  H5Tinsert(type, "i", sizeof(double), H5T_NATIVE_DOUBLE);
  return {type, H5Tclose};
}

inline Hdf5Handle string_type() {
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, H5T_VARIABLE);
  H5Tset_cset(type, H5T_CSET_UTF8);
  return {type, H5Tclose};
}

/// The HDF5 type of Number, in memory and in files.
template <typename Number>
Hdf5Handle number_type() {
  if constexpr (std::is_same_v<Number, Complex>) {
    return complex_type();
  } else if constexpr (std::is_same_v<Number, double>) {
    return {H5Tcopy(H5T_NATIVE_DOUBLE), H5Tclose};
  } else if constexpr (std::is_same_v<Number, std::uint64_t>) {
    return {H5Tcopy(H5T_NATIVE_UINT64), H5Tclose};
  } else if constexpr (std::is_same_v<Number, std::int64_t>) {
    return {H5Tcopy(H5T_NATIVE_INT64), H5Tclose};
  } else {
    static_assert(std::is_same_v<Number, std::uint8_t>);
    return {H5Tcopy(H5T_NATIVE_UINT8), H5Tclose};
  }
}

/// Also where groups on the way to `name` are missing, which H5Lexists alone calls a failure.
inline bool exists(hid_t file, const std::string& name) {
  for (std::size_t slash = name.find('/', 1); slash != std::string::npos;
       slash = name.find('/', slash + 1))
    if (H5Lexists(file, name.substr(0, slash).c_str(), H5P_DEFAULT) <= 0) return false;
  return name == "/" || H5Lexists(file, name.c_str(), H5P_DEFAULT) > 0;
}

}  // namespace flatspeckle
