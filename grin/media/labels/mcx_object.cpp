#include "grin/media/labels/mcx_object.h"

#include <algorithm>
#include <fstream>

#include "core/error.h"

namespace flatspeckle::grin {

nlohmann::json read_mcx(const std::filesystem::path& path) {
  std::ifstream file(path);
  nlohmann::json json = nlohmann::json::parse(file, nullptr, false);
  if (json.is_object()) return json;
  throw InputError(path.string() + ": is not an MCX scene: must contain one JSON object");
}

McxObject::McxObject(const nlohmann::json& json, std::string name)
    : json_(json), name_(std::move(name)) {
  if (!json_.is_object()) throw InputError(name_ + ": must be a JSON object");
}

McxObject McxObject::object(const std::string& key) const {
  return {has(key) ? json_[key] : nlohmann::json::object(), path(key)};
}

std::vector<McxObject> McxObject::objects(const std::string& key) const {
  std::vector<McxObject> list;
  if (!has(key)) return list;
  if (!json_[key].is_array()) return {object(key)};
  for (const auto& element : json_[key])
    list.emplace_back(element, path(key) + "[" + std::to_string(list.size()) + "]");
  return list;
}

double McxObject::number(const std::string& key) const {
  if (!has(key)) throw InputError(path(key) + ": is missing");
  if (!json_[key].is_number()) refuse(key, "must be a number");
  return json_[key].get<double>();
}

double McxObject::number(const std::string& key, double missing) const {
  return has(key) ? number(key) : missing;
}

bool McxObject::is_set(const std::string& key) const {
  return has(key) && (json_[key].is_boolean() ? json_[key].get<bool>() : number(key) != 0);
}

std::string McxObject::text(const std::string& key, const std::string& missing) const {
  if (!has(key)) return missing;
  if (!json_[key].is_string()) refuse(key, "must be a text");
  return json_[key].get<std::string>();
}

std::vector<double> McxObject::numbers(const std::string& key, std::size_t least,
                                       std::size_t most) const {
  if (!has(key)) return {};
  const auto& list = json_[key];
  const bool fits =
      list.is_array() && list.size() >= least && list.size() <= most &&
      std::all_of(list.begin(), list.end(), [](const auto& one) { return one.is_number(); });
  if (!fits)
    refuse(key, "must be a list of " + std::to_string(least) +
                    (most > least ? " to " + std::to_string(most) : "") + " numbers");
  return list.get<std::vector<double>>();
}

std::vector<double> McxObject::required(const std::string& key, std::size_t count) const {
  if (!has(key)) throw InputError(path(key) + ": is missing");
  return numbers(key, count, count);
}

void McxObject::refuse_others(std::initializer_list<const char*> known) const {
  for (const auto& [key, value] : json_.items()) {
    if (std::find(known.begin(), known.end(), key) != known.end() || key.starts_with("_")) continue;
    std::string list;
    for (const char* const one : known) list += (list.empty() ? "" : ", ") + std::string(one);
    throw InputError(path(key) + ": has no counterpart; accepted are " + list);
  }
}

void McxObject::refuse(const std::string& key, const std::string& accepted) const {
  throw InputError(path(key), has(key) ? json_[key].dump().substr(0, 60) : "nothing", accepted);
}

}  // namespace flatspeckle::grin
