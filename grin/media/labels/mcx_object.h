#pragma once

#include <filesystem>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace flatspeckle::grin {

/// Reads the file of an MCX scene. Throws InputError for text that is not JSON.
nlohmann::json read_mcx(const std::filesystem::path& path);

/// An object of an MCX scene; its members are named Domain.Dim and so on in messages. Functions
/// throw InputError for members of another type than expected.
class McxObject {
 public:
  McxObject(const nlohmann::json& json, std::string name);

  /// Returns a member that is an object; an empty object if it is missing.
  McxObject object(const std::string& key) const;
  /// Returns the elements of a member that is an array of objects, or a single object.
  std::vector<McxObject> objects(const std::string& key) const;

  bool has(const std::string& key) const { return json_.contains(key); }
  double number(const std::string& key) const;
  double number(const std::string& key, double missing) const;
  /// Returns whether a member is true or a number other than 0; false if it is missing.
  bool is_set(const std::string& key) const;
  std::string text(const std::string& key, const std::string& missing) const;
  /// Returns the numbers of a member, at least `least` and at most `most`; of a missing one none.
  std::vector<double> numbers(const std::string& key, std::size_t least, std::size_t most) const;
  std::vector<double> required(const std::string& key, std::size_t count) const;

  /// Throws InputError for the first member that is not among `known`.
  void refuse_others(std::initializer_list<const char*> known) const;
  /// Throws InputError: a member has a value without counterpart. accepted: what is accepted.
  [[noreturn]] void refuse(const std::string& key, const std::string& accepted) const;

  const nlohmann::json& json() const { return json_; }

 private:
  std::string path(const std::string& key) const { return name_.empty() ? key : name_ + "." + key; }

  nlohmann::json json_;
  std::string name_;
};

}  // namespace flatspeckle::grin
