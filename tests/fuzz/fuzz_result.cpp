#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <vector>

#include "core/result/hdf5_handle.h"
#include "core/result/result_reader.h"
#include "tests/fuzz/input.h"
#include "tests/fuzz/result_kinds.h"
#include "tests/fuzz/targets.h"

// Well-formed HDF5 files with wrong contents: datasets and attributes of a valid file are removed
// or replaced by others of any type, shape and values. (For damaged files see
// fuzz_result_bytes.cpp.)

namespace flatspeckle::fuzz_result {

namespace {

using fuzz::Bytes;

const char* const path = "input.h5";

Hdf5Handle compound(std::initializer_list<const char*> members, hid_t of) {
  const std::size_t size = H5Tget_size(of);
  const hid_t type = H5Tcreate(H5T_COMPOUND, size * members.size());
  std::size_t offset = 0;
  for (const char* name : members) H5Tinsert(type, name, std::exchange(offset, offset + size), of);
  return {type, H5Tclose};
}

struct AnyType {
  Hdf5Handle type;
  bool plain;  ///< arbitrary bytes are valid values
};

AnyType any_type(Bytes& bytes) {
  constexpr hsize_t two = 2;
  switch (bytes.below(16)) {
    case 0:
      return {compound({"r", "i"}, H5T_NATIVE_DOUBLE), true};
    case 1:
      return {compound({"i", "r", "x"}, H5T_NATIVE_FLOAT), true};
    case 2:
      return {compound({"r"}, H5T_NATIVE_DOUBLE), true};
    case 3: {
      const Hdf5Handle text = hdf5_type<std::string>();
      return {compound({"r", "i"}, text.get()), false};
    }
    case 4:
      return {hdf5_type<std::string>(), false};
    case 5:
      return {{H5Tcreate(H5T_STRING, 5), H5Tclose}, true};
    case 6:
      return {{H5Tvlen_create(H5T_NATIVE_DOUBLE), H5Tclose}, false};
    case 7:
      return {{H5Tarray_create2(H5T_NATIVE_DOUBLE, 1, &two), H5Tclose}, true};
    case 8:
      return {{H5Tenum_create(H5T_NATIVE_INT), H5Tclose}, true};
    case 9:
      return {{H5Tcopy(H5T_STD_REF_OBJ), H5Tclose}, false};
    case 10:
      return {{H5Tcopy(H5T_STD_I64BE), H5Tclose}, true};
    case 11:
      return {{H5Tcopy(H5T_NATIVE_UINT8), H5Tclose}, true};
    case 12:
      return {{H5Tcopy(H5T_NATIVE_LDOUBLE), H5Tclose}, true};
    case 13:
      return {{H5Tcopy(H5T_NATIVE_UINT64), H5Tclose}, true};
    default:
      return {{H5Tcopy(H5T_NATIVE_DOUBLE), H5Tclose}, true};
  }
}

/// Returns small extents, sometimes a power of two.
std::vector<hsize_t> any_shape(Bytes& bytes) {
  std::vector<hsize_t> shape(bytes.below(5));
  for (hsize_t& extent : shape) {
    const unsigned choice = bytes.below(128);
    extent = choice < 64 ? choice : hsize_t{1} << (choice - 64);
  }
  return shape;
}

Hdf5Handle space_of(const std::vector<hsize_t>& shape) {
  constexpr std::size_t none = 4;  // an empty dataset
  const hid_t space = shape.empty() ? H5Screate(H5S_SCALAR)
                      : shape.size() == none
                          ? H5Screate(H5S_NULL)
                          : H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr);
  return {space, H5Sclose};
}

/// Returns `size` bytes that repeat numbers from the input.
std::vector<std::uint8_t> numbers(Bytes& bytes, std::size_t size) {
  constexpr std::size_t most_numbers = 8;
  std::vector<double> values;
  for (unsigned count = 1 + bytes.below(most_numbers); count > 0; --count)
    values.push_back(bytes.take<double>());
  const auto* first = reinterpret_cast<const std::uint8_t*>(values.data());
  std::vector<std::uint8_t> all(size);
  for (std::size_t i = 0; i < size; ++i) all[i] = first[i % (sizeof(double) * values.size())];
  return all;
}

void replace(hid_t file, const fuzz::Stored& stored, Bytes& bytes) {
  const auto [type, plain] = any_type(bytes);
  const auto shape = any_shape(bytes);
  const Hdf5Handle space = space_of(shape);
  const Hdf5Handle layout{H5Pcreate(H5P_DATASET_CREATE), H5Pclose};
  const std::vector<hsize_t> chunk(shape.size(), 2);
  if (bytes.below(2) == 1 && !shape.empty() && shape.size() < 4) {
    H5Pset_chunk(layout.get(), static_cast<int>(chunk.size()), chunk.data());
    H5Pset_deflate(layout.get(), 1);
  }
  constexpr hssize_t most_written = 1024;
  const hssize_t count = H5Sget_simple_extent_npoints(space.get());
  const bool is_written = plain && count > 0 && count <= most_written &&
                          std::ranges::all_of(shape, [](hsize_t n) { return n <= 1024; });
  const auto values =
      numbers(bytes, is_written ? static_cast<std::size_t>(count) * H5Tget_size(type.get()) : 0);
  if (stored.attribute.empty()) {
    const Hdf5Handle set{H5Dcreate2(file, stored.object.c_str(), type.get(), space.get(),
                                    H5P_DEFAULT, layout.get(), H5P_DEFAULT),
                         H5Dclose};
    if (is_written) H5Dwrite(set.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    return;
  }
  const Hdf5Handle attribute{
      H5Acreate_by_name(file, stored.object.c_str(), stored.attribute.c_str(), type.get(),
                        space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
      H5Aclose};
  if (is_written) H5Awrite(attribute.get(), type.get(), values.data());
}

void edit(hid_t file, const fuzz::Stored& stored, Bytes& bytes) {
  if (stored.attribute.empty())
    H5Ldelete(file, stored.object.c_str(), H5P_DEFAULT);
  else
    H5Adelete_by_name(file, stored.object.c_str(), stored.attribute.c_str(), H5P_DEFAULT);
  switch (bytes.below(8)) {
    case 0:
      return;
    case 1:
      H5Gclose(H5Gcreate2(file, stored.object.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
      return;
    case 2:
      H5Lcreate_soft(stored.object.c_str(), file, stored.object.c_str(), H5P_DEFAULT, H5P_DEFAULT);
      return;
    default:
      replace(file, stored, bytes);
  }
}

std::string bytes_of(const fuzz::ResultKind& kind) {
  kind.write(path);
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

}  // namespace

void use_input(const std::uint8_t* input, std::size_t size) {
  const auto& kinds = fuzz::result_kinds();
  static std::vector<std::string> valid;
  if (valid.empty()) std::ranges::transform(kinds, std::back_inserter(valid), bytes_of);
  Bytes bytes(input, size);
  const unsigned kind = bytes.below(static_cast<unsigned>(kinds.size()));
  fuzz::write_file(path, valid[kind]);
  silence_hdf5();
  {
    const Hdf5Handle file{H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose};
    constexpr int most_edits = 4;
    const auto& stored = kinds[kind].stored;
    for (int i = 0; i < most_edits && !bytes.empty(); ++i)
      edit(file.get(), stored[bytes.below(static_cast<unsigned>(stored.size()))], bytes);
  }
  fuzz::taken(path, kinds[kind].read);
}

}  // namespace flatspeckle::fuzz_result
