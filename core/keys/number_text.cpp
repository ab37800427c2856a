#include "core/keys/number_text.h"

#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <type_traits>

namespace flatspeckle {

namespace {

template <typename Number>
std::optional<Number> read_all(const char* from, const char* end) {
  Number value{};
  if (end - from > 1 && from[0] == '+' && from[1] != '-')
    ++from;  // from_chars does not accept a plus sign
  const auto read = std::from_chars(from, end, value);
  if (read.ec == std::errc::result_out_of_range && read.ptr == end)
    if constexpr (std::is_same_v<Number, double>) return std::strtod(from, nullptr);
  if (read.ec != std::errc{} || read.ptr != end) return std::nullopt;
  return value;
}

/// Removes underscores between digits, as in 1_000, which TOML allows in scene files.
std::string without_underscores(const std::string& text) {
  const auto is_digit = [](unsigned char c) { return std::isdigit(c) != 0; };
  std::string all;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool divides = text[i] == '_' && i > 0 && i + 1 < text.size() && is_digit(text[i - 1]) &&
                         is_digit(text[i + 1]);
    if (!divides) all += text[i];
  }
  return all;
}

}  // namespace

std::string number_text(double value) {
  char digits[32];
  // adding 0 turns -0 into 0
  return {digits, std::to_chars(digits, digits + sizeof digits, value + 0.0).ptr};
}

std::string number_text(Complex value) {
  if (value.imag() == 0) return number_text(value.real());
  return number_text(value.real()) + (value.imag() > 0 ? "+" : "") + number_text(value.imag()) +
         'i';
}

std::string number_text(const std::vector<double>& values) {
  std::vector<std::string> texts;
  for (const double value : values) texts.push_back(number_text(value));
  return join_texts(texts, " ");
}

std::string join_texts(const std::vector<std::string>& texts, const std::string& between) {
  std::string all;
  for (const std::string& text : texts) all += (&text == &texts.front() ? "" : between) + text;
  return all;
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view space = " \t\r";
  const auto first = text.find_first_not_of(space);
  if (first == text.npos) return {};
  return text.substr(first, text.find_last_not_of(space) - first + 1);
}

std::optional<double> read_number(const std::string& text) {
  const std::string digits = without_underscores(text);
  return read_all<double>(digits.data(), digits.data() + digits.size());
}

std::optional<std::int64_t> read_whole_number(const std::string& text) {
  const std::string digits = without_underscores(text);
  if (const auto whole = read_all<std::int64_t>(digits.data(), digits.data() + digits.size()))
    return whole;
  constexpr double most = 1e15;
  const auto number = read_number(text);
  if (!number || std::abs(*number) > most || *number != std::floor(*number)) return std::nullopt;
  return static_cast<std::int64_t>(*number);
}

}  // namespace flatspeckle
