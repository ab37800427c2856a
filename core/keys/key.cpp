#include "core/keys/key.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <iterator>
#include <sstream>
#include <unistd.h>

#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/keys/written_number.h"

namespace flatspeckle {

namespace {

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

// Returns the value of a key as texts; an empty list if the key is not set.
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

/// Parses texts and stores the values in the variable of a key, for each type of variable.
class Setter {
 public:
  /// metres: the scene's unit of length in metres, if known.
  Setter(const Key& key, const std::optional<double>& metres, const std::vector<std::string>& texts)
      : key_(key), metres_(metres), texts_(texts) {}

  template <typename Value>
  void operator()(Value* member) const {
    if (texts_.size() != 1)
      throw InputError(key_.name() + ": must have one value, and be given once");
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
  void operator()(std::vector<double>* member) const {
    member->clear();
    for (const std::string& text : texts_) {
      const std::size_t before = member->size();
      const auto unit = [&](std::size_t number) {
        return key_.number_unit(metres_, before + number);
      };
      for (const double value : written_numbers(key_.name(), text, unit)) member->push_back(value);
    }
  }

 private:
  void read(const std::string& text, bool& value) const {
    if (text != "true" && text != "false")
      throw InputError(key_.name(), text, "must be true or false");
    value = text == "true";
  }
  void read(const std::string& text, std::int64_t& value) const {
    const auto number = read_whole_number(text);
    if (!number) throw InputError(key_.name(), text, "must be a whole number of at most 18 digits");
    value = *number;
  }
  void read(const std::string& text, double& value) const {
    const KeyUnit unit = key_.number_unit(metres_);
    const auto number = written_number(text, unit);
    if (!number) throw InputError(key_.name(), text, must_be_number(text, unit));
    value = *number;
  }
  void read(const std::string& text, std::string& value) const {
    const auto is_odd = [](unsigned char c) { return std::iscntrl(c) || c == '"' || c == '\\'; };
    if (std::any_of(text.begin(), text.end(), is_odd))
      throw InputError(key_.name(), text, "must not contain control characters, \" or \\");
    value = text;
  }

  const Key& key_;
  const std::optional<double>& metres_;
  const std::vector<std::string>& texts_;
};

template <typename... Types>
bool fills(const KeyMember& member) {
  return (std::holds_alternative<Types*>(member) || ...);
}

/// Returns a limit as text; integers as 100000, not 1e+05.
std::string limit_text(double limit) {
  constexpr double longest = 1e9;
  const bool whole = limit == std::floor(limit) && std::abs(limit) < longest;
  return whole ? std::to_string(static_cast<std::int64_t>(limit)) : number_text(limit);
}

}  // namespace

Key::Key(std::string name, KeyMember member, std::string group, std::string help)
    : name_(std::move(name)),
      group_(std::move(group)),
      help_(std::move(help)),
      member_(member),
      default_(value()) {}

bool Key::is_list() const {
  return fills<std::vector<double>, std::vector<std::int64_t>, std::vector<std::string>>(member_);
}
bool Key::is_whole() const {
  return fills<std::int64_t, std::optional<std::int64_t>, std::vector<std::int64_t>>(member_);
}
bool Key::is_number() const {
  return is_whole() || fills<double, std::optional<double>, std::vector<double>>(member_);
}

const void* Key::address() const {
  return std::visit([](const auto* member) -> const void* { return member; }, member_);
}

std::string Key::help() const {
  std::string text = help_;
  if (!words_.empty()) text += ": " + join_texts(words_, ", ");
  if (!unit_.empty()) text += " [" + unit_ + ']';
  if (!only_of_.empty()) text += " (" + only_of_ + ')';
  return text;
}

std::string Key::accepted() const {
  if (!words_.empty()) return "must be one of " + join_texts(words_, " ");
  if (exactly_ > 0) return "must be " + shape_;
  if (each_ > 0) return "must be " + std::to_string(each_) + " numbers for each: " + shape_;
  if (is_switch()) return "must be true or false";
  return is_number() ? range() : "must be a text";
}

bool Key::Range::has(double value) const {
  return std::isfinite(value) && (low_open ? value > low : value >= low) &&
         (high_open ? value < high : value <= high);
}

std::string Key::Range::text(bool whole) const {
  if (low == -infinity && high == infinity) return whole ? "must be whole" : "must be finite";
  if (low == 0 && high == infinity) return low_open ? "must be positive" : "must not be negative";
  const std::string least = limit_text(low), largest = limit_text(high);
  if (high == infinity) return (low_open ? "must be above " : "must be at least ") + least;
  return low_open ? "must be in (" + least + ", " + largest + (high_open ? ')' : ']')
                  : "must be from " + least + " to " + largest;
}

std::string Key::range() const {
  const bool angle = unit_ == "rad" && range_.high < infinity;
  return range_.text(is_whole()) + (angle ? " radians; degrees are written as in 40deg" : "");
}

std::vector<std::string> Key::value() const {
  return std::visit([](const auto* member) { return texts_of(*member); }, member_);
}

std::string Key::shown() const {
  return join_texts(value(), " ");
}

std::string Key::line() const {
  const bool bare = is_number() || is_switch();
  std::vector<std::string> texts = value();
  if (!bare)
    for (std::string& text : texts) text.insert(0, 1, '"').push_back('"');
  const std::string all = join_texts(texts, ", ");
  return name_ + " = " + (is_list() ? '[' + all + ']' : all);
}

Key& Key::units(const std::string& of_item) {
  std::istringstream words(of_item);
  units_.assign(std::istream_iterator<std::string>(words), {});
  return *this;
}

KeyUnit Key::number_unit(const std::optional<double>& metres, std::size_t position) const {
  return KeyUnit(units_.empty() ? unit_ : units_[position % units_.size()], metres);
}

void Key::set(const std::vector<std::string>& given, const std::optional<double>& metres) const {
  std::vector<std::string> texts = given;
  if (!former_.first.empty()) std::ranges::replace(texts, former_.first, former_.second);
  std::visit(Setter(*this, metres, texts), member_);
}

void Key::check() const {
  if (!given()) return;
  if (!words_.empty())
    for (const std::string& word : value())
      if (std::find(words_.begin(), words_.end(), word) == words_.end())
        throw InputError(name_, word, accepted() + gone_);
  const auto texts = value();
  if (file_)
    for (const std::string& path : texts)
      if (access(path.c_str(), R_OK) != 0)
        throw InputError(name_, path, errno == ENOENT ? "no such file" : std::strerror(errno));
  if (exactly_ > 0 && texts.size() != exactly_) {
    const bool is_twice = texts.size() == 2 * exactly_;
    const std::string twice = "; given twice (" + std::to_string(texts.size()) + " numbers)";
    throw InputError(name_, shown(), accepted() + (is_twice ? twice : ""));
  }
  if (each_ > 0 && texts.size() % each_ != 0) throw InputError(name_, shown(), accepted());
  if (is_number())
    for (const std::string& text : texts) check(*read_number(text), text);
}

void Key::check(double value, const std::string& text) const {
  if (!range_.has(value)) throw InputError(name_, exactly_ > 0 ? shown() : text, range());
  const bool positive = range_.low_open && range_.low == 0 && range_.high == infinity;
  if (positive && (value > most_input || value < 1 / most_input))
    throw InputError(name_, text, "must be from 1e-50 to 1e50");
  if (std::abs(value) > most_input) throw InputError(name_, text, "must be from -1e50 to 1e50");
}

}  // namespace flatspeckle
