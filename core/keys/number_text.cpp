#include "core/keys/number_text.h"

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <type_traits>

#include "core/error.h"

namespace flatspeckle {

namespace {

template <typename Number>
std::optional<Number> read_all(const char* from, const char* end) {
  Number value{};
  if (end - from > 1 && from[0] == '+' && from[1] != '-') ++from;  // from_chars knows no plus
  const auto read = std::from_chars(from, end, value);
  if (read.ec == std::errc::result_out_of_range && read.ptr == end)
    if constexpr (std::is_same_v<Number, double>) return std::strtod(from, nullptr);
  if (read.ec != std::errc{} || read.ptr != end) return std::nullopt;
  return value;
}

/// Reads "1.5 + 0.1i" from left to right.
class ComplexText {
 public:
  explicit ComplexText(const std::string& text)
      : at_(text.data()), end_(text.data() + text.size()) {}

  /// Nothing where the text is no such number.
  std::optional<Complex> read() {
    const double real = sign(true) * magnitude();
    blanks();
    if (at_ == end_) return ok_ ? std::optional<Complex>(real) : std::nullopt;
    double imaginary = sign(false);
    blanks();
    if (at_ != end_ && *at_ != 'i' && *at_ != 'j') imaginary *= magnitude();
    blanks();
    ok_ = ok_ && at_ != end_ && (*at_ == 'i' || *at_ == 'j');
    if (ok_) ++at_;
    blanks();
    return ok_ && at_ == end_ ? std::optional<Complex>({real, imaginary}) : std::nullopt;
  }

 private:
  void blanks() {
    while (at_ != end_ && (*at_ == ' ' || *at_ == '\t')) ++at_;
  }
  double sign(bool may_lack) {
    blanks();
    const bool there = at_ != end_ && (*at_ == '+' || *at_ == '-');
    ok_ = ok_ && (there || may_lack);
    return there && *at_++ == '-' ? -1 : 1;
  }
  double magnitude() {
    const char* const from = at_;
    ok_ = ok_ && at_ != end_ && ((*at_ >= '0' && *at_ <= '9') || *at_ == '.');
    double value = 0;
    if (!ok_) return value;
    const auto read = std::from_chars(at_, end_, value);
    ok_ = read.ec != std::errc::invalid_argument;
    at_ = read.ptr;
    return read.ec == std::errc::result_out_of_range ? std::strtod(from, nullptr) : value;
  }

  const char *at_, *end_;
  bool ok_ = true;
};

}  // namespace

std::string number_text(double value) {
  char digits[32];
  return {digits, std::to_chars(digits, digits + sizeof digits, value + 0.0).ptr};  // -0 is 0
}

std::string number_text(Complex value) {
  if (value.imag() == 0) return number_text(value.real());
  return number_text(value.real()) + (value.imag() > 0 ? "+" : "") + number_text(value.imag()) +
         'i';
}

std::string number_text(const std::vector<double>& values) {
  std::vector<std::string> texts;
  for (const double value : values) texts.push_back(number_text(value));
  return joined(texts, " ");
}

std::string joined(const std::vector<std::string>& texts, const std::string& between) {
  std::string all;
  for (const std::string& text : texts) all += (&text == &texts.front() ? "" : between) + text;
  return all;
}

std::optional<double> read_number(const std::string& text) {
  return read_all<double>(text.data(), text.data() + text.size());
}

std::optional<std::int64_t> read_whole_number(const std::string& text) {
  if (const auto whole = read_all<std::int64_t>(text.data(), text.data() + text.size()))
    return whole;
  constexpr double most = 1e15;
  const auto number = read_number(text);
  if (!number || std::abs(*number) > most || *number != std::floor(*number)) return std::nullopt;
  return static_cast<std::int64_t>(*number);
}

Complex parse_complex(const std::string& key, const std::string& text) {
  const auto value = ComplexText(text).read();
  if (!value) throw InputError(key, '"' + text + '"', "must be a number such as 1.5 or 1.5+0.1i");
  if (!std::isfinite(std::abs(*value))) throw InputError(key, text, "must be finite");
  return *value;
}

}  // namespace flatspeckle
