#include "core/result/result_reader.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <type_traits>
#include <utility>

#include <hdf5_hl.h>

#include "core/error.h"
#include "core/result/hdf5_handle.h"

namespace flatspeckle {

namespace {

/// Reads one dataset or attribute, `name`, from the HDF5 file of a ResultReader.
class Reader {
 public:
  Reader(const Hdf5Handle& file, const std::string& path, const std::string& name)
      : name_(name),
        path_(path),
        call_(path + ": " + name + " cannot be read"),
        file_(file.get()) {}

  Hdf5Handle dataset() const {
    if (!exists(file_, name_)) throw InputError(path_ + ": has no " + name_);
    return call_.handle(H5Dopen2(file_, name_.c_str(), H5P_DEFAULT), H5Dclose);
  }

  std::vector<hsize_t> shape(hid_t set) const {
    const Hdf5Handle space = call_.handle(H5Dget_space(set), H5Sclose);
    std::vector<hsize_t> shape(
        static_cast<std::size_t>(call_.check(H5Sget_simple_extent_ndims(space.get()))));
    call_.check(H5Sget_simple_extent_dims(space.get(), shape.data(), nullptr));
    return shape;
  }

  template <typename Number>
  std::vector<Number> values() const {
    const Hdf5Handle set = dataset();
    const Hdf5Handle stored = call_.handle(H5Dget_type(set.get()), H5Tclose);
    require_type<Number>(stored.get());
    std::vector<Number> values(size(set.get(), H5Tget_size(stored.get())));
    const Hdf5Handle type = hdf5_type<Number>();
    call_.check(H5Dread(set.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()));
    require_finite(values);
    return values;
  }

  std::vector<std::string> texts() const {
    const Hdf5Handle set = dataset();
    const Hdf5Handle stored = call_.handle(H5Dget_type(set.get()), H5Tclose);
    if (H5Tis_variable_str(stored.get()) <= 0) refuse_type();
    const Hdf5Handle type = hdf5_type<std::string>();
    std::vector<char*> read(size(set.get(), H5Tget_size(stored.get())));
    call_.check(H5Dread(set.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, read.data()));
    std::vector<std::string> texts;
    for (char* const text : read) {
      texts.emplace_back(text == nullptr ? "" : text);
      H5free_memory(text);
    }
    return texts;
  }

  StoredValues stored_values() const {
    const Hdf5Handle set = dataset();
    const Hdf5Handle stored = call_.handle(H5Dget_type(set.get()), H5Tclose);
    const H5T_class_t type = H5Tget_class(stored.get());
    if (type == H5T_COMPOUND) return StoredValues::complex;
    return type == H5T_STRING ? StoredValues::text : StoredValues::real;
  }

  /// Returns the path of the dimension scale of each axis; empty if an axis has none.
  std::vector<std::string> axes() const {
    const Hdf5Handle set = dataset();
    std::vector<std::string> axes(shape(set.get()).size());
    const auto note = [](hid_t, unsigned, hid_t scale, void* axis) -> herr_t {
      constexpr std::size_t longest = 1024;
      char path[longest] = "";
      if (H5Iget_name(scale, path, longest) < 0) return -1;
      *static_cast<std::string*>(axis) = path[0] == '/' ? path + 1 : path;
      return 1;  // ends the iteration: each axis has one scale
    };
    for (unsigned axis = 0; axis < axes.size(); ++axis)
      if (H5DSget_num_scales(set.get(), axis) > 0)
        call_.check(H5DSiterate_scales(set.get(), axis, nullptr, note, &axes[axis]));
    return axes;
  }

  Hdf5Handle attribute(const std::string& attribute) const {
    if (!exists(file_, name_)) throw InputError(path_ + ": has no " + name_);
    if (H5Aexists_by_name(file_, name_.c_str(), attribute.c_str(), H5P_DEFAULT) <= 0)
      throw InputError(path_ + ": " + name_ + " has no attribute " + attribute);
    return call_.handle(
        H5Aopen_by_name(file_, name_.c_str(), attribute.c_str(), H5P_DEFAULT, H5P_DEFAULT),
        H5Aclose);
  }

  template <typename Number>
  std::vector<Number> numbers(hid_t attribute) const {
    const Hdf5Handle stored = call_.handle(H5Aget_type(attribute), H5Tclose);
    require_type<Number>(stored.get());
    std::vector<Number> values(attribute_size(attribute));
    const Hdf5Handle type = hdf5_type<Number>();
    if (!values.empty()) call_.check(H5Aread(attribute, type.get(), values.data()));
    require_finite(values);
    return values;
  }

  std::string text(hid_t attribute) const {
    const Hdf5Handle stored = call_.handle(H5Aget_type(attribute), H5Tclose);
    if (H5Tis_variable_str(stored.get()) <= 0 || attribute_size(attribute) != 1) call_.check(-1);
    const Hdf5Handle type = hdf5_type<std::string>();
    char* text = nullptr;
    call_.check(H5Aread(attribute, type.get(), &text));
    std::string value = text == nullptr ? "" : text;
    H5free_memory(text);
    return value;
  }

  template <typename Value>
  Value only(const std::vector<Value>& values) const {
    if (values.size() != 1) call_.check(-1);
    return values.front();
  }

 private:
  /// Returns the number of values of a dataset. Throws InputError if the file cannot contain that
  /// many, because HDF5 would fill memory with default values for the missing ones.
  std::size_t size(hid_t set, std::size_t number_bytes) const {
    constexpr double most_shrinkage = 1100;  // deflate, the compression of HDF5, reaches 1032
    hsize_t file_bytes = 0;
    call_.check(H5Fget_filesize(file_, &file_bytes));
    const auto stored = static_cast<double>(std::min(H5Dget_storage_size(set), file_bytes));
    double bytes = static_cast<double>(number_bytes);
    const auto extents = shape(set);
    for (const hsize_t extent : extents) bytes *= static_cast<double>(extent);
    if (bytes > most_shrinkage * stored)
      throw InputError(path_ + ": " + name_ + " declares more values than the file contains");
    return std::accumulate(extents.begin(), extents.end(), std::size_t{1}, std::multiplies<>());
  }

  std::size_t attribute_size(hid_t attribute) const {
    const Hdf5Handle space = call_.handle(H5Aget_space(attribute), H5Sclose);
    const auto count = call_.check(H5Sget_simple_extent_npoints(space.get()));
    if (static_cast<hsize_t>(count) > H5Aget_storage_size(attribute)) call_.check(-1);
    return static_cast<std::size_t>(count);
  }

  /// Throws InputError if a number is not finite: ResultFile never writes such numbers, and no
  /// caller can use them.
  template <typename Number>
  void require_finite(const std::vector<Number>& values) const {
    if (!all_finite<Number>(values))
      throw InputError(path_ + ": " + name_ + " contains a number that is not finite");
  }

  /// Throws InputError if the stored type is not that of Number. HDF5 itself would convert 1.5 to
  /// the integer 1, and unknown compound types to zeros.
  template <typename Number>
  void require_type(hid_t stored) const {
    const H5T_class_t type = H5Tget_class(stored);
    bool right = type == H5T_INTEGER;
    if constexpr (std::is_same_v<Number, double>) right = right || type == H5T_FLOAT;
    if constexpr (std::is_same_v<Number, Complex>)
      right = type == H5T_COMPOUND && H5Tget_member_index(stored, "r") >= 0 &&
              H5Tget_member_index(stored, "i") >= 0;
    if (!right) refuse_type();
  }
  [[noreturn]] void refuse_type() const {
    throw InputError(path_ + ": " + name_ + " is of another type than expected");
  }

  std::string name_, path_;
  Hdf5Calls<InputError> call_;
  hid_t file_;
};

}  // namespace

ResultReader::ResultReader(std::filesystem::path path) : path_(std::move(path)) {
  silence_hdf5();
  const Hdf5Calls<InputError> call(path_.string() + ": not a readable HDF5 file");
  file_ = std::make_unique<Hdf5Handle>(
      call.handle(H5Fopen(path_.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose));
}

ResultReader::ResultReader(ResultReader&&) noexcept = default;
ResultReader& ResultReader::operator=(ResultReader&&) noexcept = default;
ResultReader::~ResultReader() = default;

bool ResultReader::has(const std::string& name) const {
  return exists(file_->get(), name);
}

bool ResultReader::has_attribute(const std::string& object, const std::string& name) const {
  return has(object) &&
         H5Aexists_by_name(file_->get(), object.c_str(), name.c_str(), H5P_DEFAULT) > 0;
}

std::vector<std::string> ResultReader::members(const std::string& group) const {
  std::vector<std::string> names;
  if (!has(group)) return names;
  const auto note = [](hid_t, const char* name, const H5L_info_t*, void* all) -> herr_t {
    static_cast<std::vector<std::string>*>(all)->emplace_back(name);
    return 0;
  };
  H5Literate_by_name(file_->get(), group.c_str(), H5_INDEX_NAME, H5_ITER_INC, nullptr, note, &names,
                     H5P_DEFAULT);
  return names;
}

std::vector<std::size_t> ResultReader::shape(const std::string& name) const {
  const Reader reader(*file_, path_.string(), name);
  const auto extents = reader.shape(reader.dataset().get());
  return {extents.begin(), extents.end()};
}

std::vector<std::string> ResultReader::datasets() const {
  std::vector<std::string> found;
  const std::function<void(const std::string&)> search = [&](const std::string& group) {
    for (const std::string& member : members(group.empty() ? "/" : group)) {
      const std::string path = group.empty() ? member : group + '/' + member;
      const Hdf5Handle object(H5Oopen(file_->get(), path.c_str(), H5P_DEFAULT), H5Oclose);
      const H5I_type_t type = H5Iget_type(object.get());
      if (type == H5I_DATASET) found.push_back(path);
      if (type == H5I_GROUP) search(path);
    }
  };
  search("");
  return found;
}

StoredValues ResultReader::stored_values(const std::string& name) const {
  return Reader(*file_, path_.string(), name).stored_values();
}

std::vector<std::string> ResultReader::axes(const std::string& name) const {
  return Reader(*file_, path_.string(), name).axes();
}

template <typename Value>
std::vector<Value> ResultReader::dataset(const std::string& name) const {
  const Reader reader(*file_, path_.string(), name);
  if constexpr (std::is_same_v<Value, std::string>)
    return reader.texts();
  else
    return reader.values<Value>();
}

template std::vector<double> ResultReader::dataset(const std::string&) const;
template std::vector<Complex> ResultReader::dataset(const std::string&) const;
template std::vector<std::string> ResultReader::dataset(const std::string&) const;

template <typename Value>
Value ResultReader::attribute(const std::string& object, const std::string& name) const {
  const Reader reader(*file_, path_.string(), object);
  const Hdf5Handle attribute = reader.attribute(name);
  if constexpr (std::is_same_v<Value, std::string>)
    return reader.text(attribute.get());
  else if constexpr (std::is_same_v<Value, bool>)
    return reader.only(reader.numbers<std::uint8_t>(attribute.get())) != 0;
  else if constexpr (std::is_arithmetic_v<Value>)
    return reader.only(reader.numbers<Value>(attribute.get()));
  else
    return reader.numbers<typename Value::value_type>(attribute.get());
}

template bool ResultReader::attribute(const std::string&, const std::string&) const;
template std::uint64_t ResultReader::attribute(const std::string&, const std::string&) const;
template double ResultReader::attribute(const std::string&, const std::string&) const;
template std::string ResultReader::attribute(const std::string&, const std::string&) const;
template std::vector<double> ResultReader::attribute(const std::string&, const std::string&) const;

}  // namespace flatspeckle
