#include "core/keys/key.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <sstream>

#include "core/error.h"
#include "core/keys/number_text.h"

namespace flatspeckle {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
/// Of what must be positive: products of a few of them stay numbers.
constexpr double most = 1e50;

std::string text_of(bool value) {
  return value ? "true" : "false";
}
std::string text_of(std::int64_t value) {
  return std::to_string(value);
}
std::string text_of(double value) {
  return number_text(value);
}
const std::string& text_of(const std::string& value) {
  return value;
}

// What a member holds, as texts; nothing where it is not set.
template <typename Value>
std::vector<std::string> texts_of(const Value& value) {
  const std::string text = text_of(value);
  return text.empty() ? std::vector<std::string>{} : std::vector{text};
}
template <typename Value>
std::vector<std::string> texts_of(const std::optional<Value>& value) {
  return value ? texts_of(*value) : std::vector<std::string>{};
}
template <typename Value>
std::vector<std::string> texts_of(const std::vector<Value>& values) {
  std::vector<std::string> texts;
  for (const Value& value : values) texts.push_back(text_of(value));
  return texts;
}

/// Reads texts into members.
class Setter {
 public:
  Setter(const std::string& name, const std::vector<std::string>& texts)
      : name_(name), texts_(texts) {}

  template <typename Value>
  void operator()(Value* member) const {
    if (texts_.size() != 1) throw InputError(name_ + ": must have one value, and be given once");
    read(texts_.front(), *member);
  }
  template <typename Value>
  void operator()(std::optional<Value>* member) const {
    Value value{};
    (*this)(&value);
    *member = value;
  }
  template <typename Value>
  void operator()(std::vector<Value>* member) const {
    member->clear();
    for (const std::string& text : texts_) read(text, member->emplace_back());
  }

 private:
  void read(const std::string& text, bool& value) const {
    if (text != "true" && text != "false") throw InputError(name_, text, "must be true or false");
    value = text == "true";
  }
  void read(const std::string& text, std::int64_t& value) const {
    const auto number = read_whole_number(text);
    if (!number) throw InputError(name_, text, "must be a whole number of at most 18 digits");
    value = *number;
  }
  void read(const std::string& text, double& value) const {
    const auto number = read_number(text);
    if (!number) throw InputError(name_, text, "must be a number");
    value = *number;
  }
  void read(const std::string& text, std::string& value) const {
    const auto is_odd = [](unsigned char c) { return std::iscntrl(c) || c == '"' || c == '\\'; };
    if (std::any_of(text.begin(), text.end(), is_odd))
      throw InputError(name_, text, "must be without control characters, \" and \\");
    value = text;
  }

  const std::string& name_;
  const std::vector<std::string>& texts_;
};

/// The numbers that a member holds.
struct Numbers {
  std::vector<double> operator()(const auto*) const { return {}; }
  std::vector<double> operator()(const double* value) const { return {*value}; }
  std::vector<double> operator()(const std::int64_t* value) const {
    return {static_cast<double>(*value)};
  }
  std::vector<double> operator()(const std::vector<double>* values) const { return *values; }
  std::vector<double> operator()(const std::vector<std::int64_t>* values) const {
    return {values->begin(), values->end()};
  }
  std::vector<double> operator()(const std::optional<double>* value) const {
    return *value ? std::vector{**value} : std::vector<double>{};
  }
  std::vector<double> operator()(const std::optional<std::int64_t>* value) const {
    return *value ? (*this)(&**value) : std::vector<double>{};
  }
};

std::string joined(const std::vector<std::string>& texts, const std::string& between) {
  std::string all;
  for (const std::string& text : texts) all += (all.empty() ? "" : between) + text;
  return all;
}

}  // namespace

Key::Key(std::string name, KeyMember member, std::string group, std::string help)
    : name_(std::move(name)),
      group_(std::move(group)),
      help_(std::move(help)),
      member_(member),
      default_(value()) {}

Key& Key::positive() {
  return between(0, infinity);
}
Key& Key::from(double low, double high) {
  low_ = low;
  high_ = high;
  low_open_ = high_open_ = false;
  return *this;
}
Key& Key::positive_to(double high) {
  low_ = 0;
  high_ = high;
  high_open_ = false;
  return *this;
}
Key& Key::angle() {
  return from(-2 * std::numbers::pi, 2 * std::numbers::pi).unit("rad");
}
Key& Key::between(double low, double high) {
  low_ = low;
  high_ = high;
  return *this;
}
Key& Key::one_of(std::vector<std::string> words) {
  words_ = std::move(words);
  return *this;
}
Key& Key::each_of(std::size_t numbers, std::string what) {
  each_ = numbers;
  shape_ = std::move(what);
  return *this;
}
Key& Key::exactly(std::size_t numbers, std::string what) {
  exactly_ = numbers;
  shape_ = std::move(what);
  return *this;
}
Key& Key::unit(std::string text) {
  unit_ = std::move(text);
  return *this;
}
Key& Key::only_of(std::string what) {
  only_of_ = std::move(what);
  return *this;
}
Key& Key::effort() {
  effort_ = true;
  return *this;
}
Key& Key::no_file() {
  in_files_ = false;
  return *this;
}
Key& Key::swept() {
  swept_ = true;
  return *this;
}
Key& Key::file() {
  file_ = true;
  return *this;
}

bool Key::is_list() const {
  return std::holds_alternative<std::vector<double>*>(member_) ||
         std::holds_alternative<std::vector<std::int64_t>*>(member_) ||
         std::holds_alternative<std::vector<std::string>*>(member_);
}

bool Key::is_whole() const {
  return std::holds_alternative<std::int64_t*>(member_) ||
         std::holds_alternative<std::optional<std::int64_t>*>(member_) ||
         std::holds_alternative<std::vector<std::int64_t>*>(member_);
}

bool Key::is_number() const {
  return is_whole() || std::holds_alternative<double*>(member_) ||
         std::holds_alternative<std::optional<double>*>(member_) ||
         std::holds_alternative<std::vector<double>*>(member_);
}

const void* Key::address() const {
  return std::visit([](const auto* member) -> const void* { return member; }, member_);
}

std::string Key::help() const {
  std::string text = help_;
  if (!words_.empty()) text += ": " + joined(words_, ", ");
  if (!unit_.empty()) text += " [" + unit_ + ']';
  if (!only_of_.empty()) text += " (" + only_of_ + ')';
  return text;
}

std::string Key::accepted() const {
  if (!words_.empty()) return "must be one of " + joined(words_, " ");
  if (exactly_ > 0) return "must be " + shape_;
  return is_number() ? range() : "must be a text";
}

/// 100000, not 1e+05.
static std::string limit_text(double limit) {
  constexpr double most = 1e9;
  const bool whole = limit == std::floor(limit) && std::abs(limit) < most;
  return whole ? std::to_string(static_cast<std::int64_t>(limit)) : number_text(limit);
}

std::string Key::range() const {
  if (low_ == -infinity && high_ == infinity)
    return is_whole() ? "must be whole" : "must be finite";
  if (low_ == 0 && high_ == infinity)
    return low_open_ ? "must be positive" : "must not be negative";
  if (high_ == infinity)
    return (low_open_ ? "must be above " : "must be at least ") + limit_text(low_);
  const std::string low = limit_text(low_), high = limit_text(high_);
  return low_open_ ? "must be in (" + low + ", " + high + (high_open_ ? ')' : ']')
                   : "must be from " + low + " to " + high + (unit_ == "rad" ? " radians" : "");
}

std::vector<std::string> Key::value() const {
  return std::visit([](const auto* member) { return texts_of(*member); }, member_);
}

std::string Key::shown() const {
  return joined(value(), " ");
}

std::string Key::line() const {
  const bool bare = is_number() || is_switch();
  std::vector<std::string> texts = value();
  if (!bare)
    for (std::string& text : texts) text = '"' + text + '"';
  const std::string all = joined(texts, ", ");
  return name_ + " = " + (is_list() ? '[' + all + ']' : all);
}

void Key::set(const std::vector<std::string>& texts) const {
  std::visit(Setter(name_, texts), member_);
}

bool Key::allows(double value) const {
  if (!std::isfinite(value)) return false;
  return (low_open_ ? value > low_ : value >= low_) &&
         (high_open_ ? value < high_ : value <= high_);
}

void Key::check() const {
  if (!given()) return;
  if (!words_.empty())
    for (const std::string& word : value())
      if (std::find(words_.begin(), words_.end(), word) == words_.end())
        throw InputError(name_, word, accepted());
  if (file_ && !std::filesystem::exists(shown())) throw InputError(name_, shown(), "no such file");
  const auto numbers = std::visit(Numbers{}, member_);
  if (exactly_ > 0 && numbers.size() != exactly_) throw InputError(name_, shown(), accepted());
  if (each_ > 0 && numbers.size() % each_ != 0)
    throw InputError(name_, shown(),
                     "must be " + std::to_string(each_) + " numbers for each: " + shape_);
  const auto texts = value();
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const double number = numbers[i];
    if (!allows(number)) throw InputError(name_, exactly_ > 0 ? shown() : texts[i], range());
    if (low_open_ && low_ == 0 && high_ == infinity && (number > most || number < 1 / most))
      throw InputError(name_, texts[i], "must be from 1e-50 to 1e50");
  }
}

}  // namespace flatspeckle
