#include "core/keys/written_number.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string_view>

#include "core/error.h"
#include "core/keys/number_text.h"

namespace flatspeckle {

namespace {

constexpr std::int64_t most_steps = 1'000'000;
constexpr const char* range_form =
    "must be first:last:count, or first:last:count:log with first and last of the same sign; "
    "0:1:11 has steps of 0.1";

/// Parser of a number (the grammar is in the header). It removes parsed parts from the text.
class NumberParser {
 public:
  NumberParser(std::string_view text, const KeyUnit& unit) : left_(text), unit_(unit) {}

  /// Returns the number; nullopt if the text is not one, with the reason in problem().
  std::optional<double> parse() {
    if (const auto number = read_number(std::string(trimmed(left_)))) return number;
    auto sum = term();
    while (sum && !skip_blanks().empty()) {
      const char sign = left_.front();
      if (sign != '+' && sign != '-') return std::nullopt;
      left_.remove_prefix(1);
      const auto next = term();
      if (!next) return std::nullopt;
      *sum += sign == '-' ? -*next : *next;
    }
    return sum;
  }

  /// Whether a number had a unit.
  bool has_unit() const { return has_unit_; }
  const std::string& problem() const { return problem_; }

 private:
  std::string_view skip_blanks() { return left_ = trimmed(left_); }

  bool take(std::string_view start) {
    const bool found = left_.starts_with(start);
    if (found) left_.remove_prefix(start.size());
    return found;
  }

  /// Takes a number without sign, inf and nan from the start of the text.
  std::optional<double> take_figure() {
    const auto is_digit = [&](std::size_t at) {
      return at < left_.size() && std::isdigit(static_cast<unsigned char>(left_[at])) != 0;
    };
    std::size_t end = 0;
    while (is_digit(end) || (end < left_.size() && (left_[end] == '.' || left_[end] == '_'))) ++end;
    if (end < left_.size() && (left_[end] == 'e' || left_[end] == 'E')) {
      const bool has_sign =
          end + 1 < left_.size() && (left_[end + 1] == '+' || left_[end + 1] == '-');
      std::size_t power = end + (has_sign ? 2 : 1);
      while (is_digit(power)) ++power;
      if (is_digit(power - 1)) end = power;
    }
    const auto number = read_number(std::string(left_.substr(0, end)));
    left_.remove_prefix(end);
    return number;
  }

  /// Takes a sign, a number and "pi", of which one must be there.
  std::optional<double> take_factor() {
    skip_blanks();
    const bool minus = take("-");
    if (!minus) take("+");
    const bool is_pi = left_.starts_with("pi");
    auto number = is_pi ? std::optional(1.0) : take_figure();
    skip_blanks();
    if (number && (is_pi || starts_with_pi()) && take("pi")) *number *= std::numbers::pi;
    return number && minus ? -*number : number;
  }
  /// Whether the text starts with "pi" and not with a longer word.
  bool starts_with_pi() const {
    return left_.starts_with("pi") && (left_.size() == 2 || !is_letter(left_[2]));
  }

  static bool is_letter(unsigned char c) { return std::isalpha(c) != 0; }
  /// Whether a unit follows, which begins with a letter or with a slash before a letter.
  bool unit_follows() {
    const std::string_view rest = skip_blanks();
    const std::string_view name = rest.starts_with('/') ? trimmed(rest.substr(1)) : rest;
    return !name.empty() && is_letter(static_cast<unsigned char>(name.front()));
  }
  /// Takes the text of a unit: up to a sign of a sum or a divisor.
  std::string_view take_unit() {
    std::size_t end = left_.starts_with('/') ? 1 : 0;
    for (; end < left_.size(); ++end) {
      const char c = left_[end];
      const auto next = trimmed(left_.substr(end + 1));
      const bool divides =
          c == '/' && !next.empty() && !is_letter(static_cast<unsigned char>(next.front()));
      const bool is_sum = (c == '+' || c == '-') && left_[end - 1] != '^';
      if (divides || is_sum) break;
    }
    const auto text = trimmed(left_.substr(0, end));
    left_.remove_prefix(end);
    return text;
  }

  std::optional<double> term() {
    const std::string_view start = skip_blanks();
    auto value = take_factor();
    if (!value) return std::nullopt;
    if (unit_follows()) {
      value = in_unit_of_key(*value, take_unit());
      if (!value) return std::nullopt;
    }
    const auto dividend = trimmed(start.substr(0, start.size() - left_.size()));
    if (skip_blanks(); !take("/")) return value;
    return divided(*value, dividend);
  }

  std::optional<double> in_unit_of_key(double number, std::string_view text) {
    const auto unit = unit_of(text);
    if (!unit || !unit_.accepts(*unit)) return std::nullopt;
    has_unit_ = true;
    if (!unit_.lacks_length(*unit)) return unit_.convert(number, *unit);
    problem_ =
        "has a unit: also give length_unit, such as length_unit = um, the unit of all lengths "
        "given "
        "without one";
    return std::nullopt;
  }

  /// Divides by the number at the start of the text, after which no unit may follow.
  std::optional<double> divided(double value, std::string_view dividend) {
    const std::string_view start = skip_blanks();
    const bool minus = take("-");
    const auto divisor = take_figure();
    const auto figures = trimmed(start.substr(0, start.size() - left_.size()));
    if (!divisor || *divisor == 0) return std::nullopt;
    if (!unit_follows()) return value / (minus ? -*divisor : *divisor);
    const std::string name(take_unit());
    if (const auto unit = unit_of(name); unit && unit_.accepts(*unit))
      problem_ = "a divisor must have no unit; a unit belongs to the number before it, as in " +
                 std::string(dividend) + (has_unit_ ? "" : name) + '/' + std::string(figures);
    return std::nullopt;
  }

  std::string_view left_;
  const KeyUnit& unit_;
  std::string problem_;
  bool has_unit_ = false;
};

std::vector<std::string> parts_of(const std::string& text, char between) {
  std::vector<std::string> parts(1);
  for (const char letter : text)
    if (letter == between)
      parts.emplace_back();
    else
      parts.back() += letter;
  return parts;
}

/// Parses a number that is written with digits; does not accept inf and nan.
std::optional<double> read_digits(std::string_view text) {
  const std::string digits(trimmed(text));
  if (digits.find_first_not_of("+-.eE0123456789") != digits.npos) return std::nullopt;
  return read_number(digits);
}

std::optional<Complex> read_complex(std::string_view text) {
  text = trimmed(text);
  if (!text.ends_with('i') && !text.ends_with('j')) return read_digits(text);
  text.remove_suffix(1);
  std::size_t sign = text.find_last_of("+-");
  if (sign != 0 && sign != text.npos &&
      std::tolower(text[sign - 1]) == 'e')  // this sign belongs to an exponent
    sign = text.find_last_of("+-", sign - 1);
  if (sign == text.npos) return std::nullopt;
  const auto size = trimmed(text.substr(sign + 1));
  const auto real = read_digits(text.substr(0, sign));
  const auto imaginary = size.empty() ? 1 : read_digits(size);
  if (!real || !imaginary) return std::nullopt;
  return Complex(*real, text[sign] == '-' ? -*imaginary : *imaginary);
}

/// Returns why a number with a unit is not accepted; empty for accepted and for all other texts.
std::string problem_of(const std::string& text, const KeyUnit& unit) {
  NumberParser parser(text, unit);
  parser.parse();
  return parser.problem();
}

}  // namespace

std::optional<double> written_number(const std::string& text, const KeyUnit& unit) {
  return NumberParser(text, unit).parse();
}

std::string must_be_number(const std::string& text, const KeyUnit& unit) {
  const std::string problem = problem_of(text, unit);
  return problem.empty() ? unit.accepted() : problem;
}

std::string without_units(const std::string& text, const KeyUnit& unit) {
  std::string plain;
  for (std::size_t at = 0, end; at <= text.size(); at = end + 1) {
    end = std::min(text.find_first_of(",:", at), text.size());
    const std::string part = text.substr(at, end - at);
    NumberParser parser(part, unit);
    const auto value = parser.parse();
    plain += value && parser.has_unit() ? number_text(*value) : part;
    if (end < text.size()) plain += text[end];
  }
  return plain;
}

Complex parse_complex(const std::string& key, const std::string& text) {
  // A sum without i, such as 1.5+0.1, is refused: the i may be forgotten.
  const bool is_ratio = text.find('/') != text.npos && text.find_first_of("+-", 1) == text.npos;
  const auto ratio = is_ratio ? written_number(text, KeyUnit()) : std::nullopt;
  const auto value = ratio ? Complex(*ratio) : read_complex(text);
  if (!value) throw InputError(key, '"' + text + '"', "must be a number such as 1.5 or 1.5+0.1i");
  if (!std::isfinite(std::abs(*value))) throw InputError(key, text, "must be finite");
  return *value;
}

double NumberRange::at(std::size_t number) const {
  if (number + 1 == count) return last;
  const double step = (last - first) / static_cast<double>(count - 1);
  const bool is_whole =
      std::isfinite(step) && first == std::round(first) && step == std::round(step);
  if (!in_ratios && is_whole) return first + step * static_cast<double>(number);
  const double share = static_cast<double>(number) / static_cast<double>(count - 1);
  return in_ratios ? first * std::pow(last / first, share) : first * (1 - share) + last * share;
}

std::optional<std::size_t> NumberRange::find(double value) const {
  std::size_t low = 0, high = count;
  while (low < high) {
    const std::size_t middle = (low + high) / 2;
    const bool is_before = first < last ? at(middle) < value : at(middle) > value;
    (is_before ? low : high) = is_before ? middle + 1 : middle;
  }
  return low < count && at(low) == value ? std::optional(low) : std::nullopt;
}

std::optional<NumberRange> written_range(const std::string& key, const std::string& text,
                                         const KeyUnit& unit) {
  if (text.find(':') == text.npos || text.find(',') != text.npos) return std::nullopt;
  const auto parts = parts_of(text, ':');
  const bool ratios = parts.size() == 4 && trimmed(parts[3]) == "log";
  const auto refuse = [&] { return InputError(key, text, range_form); };
  if (parts.size() != 3 && !ratios) throw refuse();
  for (const std::string& end : {parts[0], parts[1]})
    if (const std::string problem = problem_of(end, unit); !problem.empty())
      throw InputError(key, text, problem);
  const auto first = written_number(parts[0], unit), last = written_number(parts[1], unit);
  const auto count = read_whole_number(std::string(trimmed(parts[2])));
  if (!first || !last || !count || !std::isfinite(*first) || !std::isfinite(*last)) throw refuse();
  if (*count < 2 || *count > most_steps)
    throw InputError(key, text, "a range must have 2 to " + std::to_string(most_steps) + " values");
  if (ratios && !(*first * *last > 0)) throw refuse();
  return NumberRange{*first, *last, static_cast<std::size_t>(*count), ratios};
}

std::vector<double> written_numbers(const std::string& key, const std::string& text,
                                    const std::function<KeyUnit(std::size_t)>& unit_of_number) {
  std::vector<double> values;
  for (const std::string& part : parts_of(text, ',')) {
    const KeyUnit unit = unit_of_number(values.size());
    if (const auto range = written_range(key, part, unit)) {
      for (std::size_t i = 0; i < range->count; ++i) values.push_back(range->at(i));
      continue;
    }
    const auto value = written_number(part, unit);
    if (!value) throw InputError(key, text, must_be_number(part, unit));
    values.push_back(*value);
  }
  return values;
}

std::vector<double> written_numbers(const std::string& key, const std::string& text,
                                    const KeyUnit& unit) {
  return written_numbers(key, text, [&](std::size_t) { return unit; });
}

}  // namespace flatspeckle
