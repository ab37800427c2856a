#include "core/keys/table_text.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <optional>
#include <utility>

#include "core/error.h"
#include "core/keys/number_text.h"

namespace flatspeckle {

std::string file_bytes(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string name = path.string();
  if (!file) throw InputError(name + ": cannot read this file: " + std::strerror(errno));
  if (std::filesystem::is_directory(path)) throw InputError(name + ": cannot read a folder");
  std::string bytes;
  std::array<char, 1 << 16> part;
  while (file.read(part.data(), part.size()), file.gcount() > 0)
    bytes.append(part.data(), static_cast<std::size_t>(file.gcount()));
  if (file.bad()) throw InputError(name + ": cannot read this file: " + std::strerror(errno));
  return bytes;
}

namespace {

void append_utf8(std::string& text, unsigned unit) {
  const auto add = [&](unsigned byte) { text += static_cast<char>(byte); };
  if (unit < 0x80) return add(unit);
  if (unit >= 0x800) add(0xE0 | unit >> 12);
  add(unit < 0x800 ? 0xC0 | unit >> 6 : 0x80 | (unit >> 6 & 0x3F));
  add(0x80 | (unit & 0x3F));
}

/// Converts UTF-16 to UTF-8; characters beyond 16 bits, which no number or column name needs,
/// become question marks.
std::string from_utf16(std::string_view bytes, bool big_endian) {
  std::string text;
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
    const unsigned first = static_cast<unsigned char>(bytes[i]),
                   second = static_cast<unsigned char>(bytes[i + 1]);
    const unsigned unit = big_endian ? first << 8 | second : second << 8 | first;
    append_utf8(text, unit >= 0xD800 && unit < 0xE000 ? '?' : unit);
  }
  return text;
}

/// Converts the bytes to UTF-8. The byte order mark determines their encoding or, if there is none,
/// the position of the zero byte of the first letter.
std::string decoded(const std::string& bytes) {
  const std::string_view all = bytes;
  if (all.starts_with("\xEF\xBB\xBF")) return bytes.substr(3);
  if (all.starts_with("\xFF\xFE")) return from_utf16(all.substr(2), false);
  if (all.starts_with("\xFE\xFF")) return from_utf16(all.substr(2), true);
  if (bytes.size() < 2 || (bytes[0] == '\0') == (bytes[1] == '\0')) return bytes;
  return from_utf16(all, bytes[0] == '\0');
}

void replace_all(std::string& text, std::string_view from, std::string_view to) {
  if (text.find(from) == text.npos) return;
  std::string replaced;
  std::size_t done = 0;
  for (std::size_t at; (at = text.find(from, done)) != text.npos; done = at + from.size())
    replaced.append(text, done, at - done).append(to);
  text = replaced + text.substr(done);
}

/// Splits a line into fields and removes spaces around them. Returns nullopt if quotation marks do
/// not match.
std::optional<std::vector<std::string>> split(std::string_view line, char separator) {
  enum class Quotes { none, open, closed } quotes = Quotes::none;
  std::vector<std::string> fields(1);
  const auto is_blank = [](const std::string& field) { return trimmed(field).empty(); };
  for (std::size_t i = 0; i < line.size(); ++i) {
    std::string& field = fields.back();
    const bool divides = line[i] == separator || (separator == ' ' && line[i] == '\t');
    if (line[i] == '"' && quotes == Quotes::open) {
      const bool is_doubled = line.substr(i + 1).starts_with('"');
      if (is_doubled) field += line[i++];
      if (!is_doubled) quotes = Quotes::closed;
    } else if (line[i] == '"') {
      if (!is_blank(field) || quotes == Quotes::closed) return std::nullopt;
      quotes = Quotes::open;
    } else if (quotes != Quotes::open && divides) {
      if (separator == ' ' && is_blank(field) && quotes == Quotes::none) continue;
      fields.emplace_back();
      quotes = Quotes::none;
    } else {
      if (quotes == Quotes::closed && line[i] != ' ' && line[i] != '\t') return std::nullopt;
      field += line[i];
    }
  }
  if (quotes == Quotes::open) return std::nullopt;
  for (std::string& field : fields) field = trimmed(field);
  return fields;
}

std::size_t count_of(std::string_view line, char separator) {
  const auto fields = split(line, separator);
  return fields ? fields->size() : 0;
}

/// Whether all fields of a line are numbers, possibly with decimal commas.
bool are_numbers(std::vector<std::string> fields) {
  std::erase(fields, "");
  return !fields.empty() && std::ranges::all_of(fields, [](std::string field) {
    std::ranges::replace(field, ',', '.');
    return read_number(field).has_value();
  });
}

}  // namespace

TableText::TableText(const std::filesystem::path& path, bool named) : path_(path.string()) {
  std::string text = decoded(file_bytes(path));
  const auto is_binary = [](unsigned char c) {
    return c < ' ' && c != '\t' && c != '\n' && c != '\r' && c != '\f';
  };
  if (std::ranges::any_of(text, is_binary))
    throw InputError(path_ +
                     ": is not a text file; a table must be CSV, as spreadsheets export it");
  replace_all(text, "\xE2\x88\x92", "-");  // the Unicode minus sign
  for (const char* space : {"\xC2\xA0", "\xE2\x80\xAF"}) replace_all(text, space, " ");
  replace_all(text, "\r\n", "\n");
  std::ranges::replace(text, '\r', '\n');
  split_lines(text);
  take_separator();
  if (separator_ == '\0') find_separator(named);
  if (named) take_names();
}

void TableText::split_lines(std::string_view text) {
  std::size_t number = 1;
  for (std::size_t end; !text.empty(); text.remove_prefix(end), ++number) {
    end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end), content = trimmed(line);
    if (end < text.size()) ++end;
    if (content.empty()) continue;
    const bool is_comment = content.front() == '#' || content.front() == '%';
    if (!is_comment) lines_.push_back({number, std::string(line)});
    if (is_comment && lines_.empty()) comment_ = {number, std::string(content.substr(1))};
  }
}

/// If the first line is of the form "sep=;", as written by Excel, takes the separator from it and
/// removes the line.
void TableText::take_separator() {
  if (lines_.empty()) return;
  std::string first = lines_.front().text;
  std::erase(first, '"');
  if (first.size() != 5 || !(first.starts_with("sep=") || first.starts_with("SEP="))) return;
  separator_ = first.back();
  if (std::string_view(";,\t |").find(separator_) == std::string_view::npos)
    fail(lines_.front(), first + ": fields must be separated by , ; | a tab or a space");
  lines_.erase(lines_.begin());
}

/// Chooses the separator: the first of several characters that splits the first two lines into the
/// same number of fields, more than one. If there is none, chooses a character that splits the
/// first line, but not a space if that line has column names, because names may contain spaces.
void TableText::find_separator(bool named) {
  separator_ = ',';
  if (lines_.empty()) return;
  for (const bool agree : {true, false})
    for (const char candidate : std::string_view(named ? ";,\t " : ";\t, ")) {
      const std::size_t count = count_of(trimmed(lines_.front().text), candidate);
      const bool same = lines_.size() < 2 || count_of(trimmed(lines_[1].text), candidate) == count;
      if (count < 2 || (agree ? !same : named && candidate == ' ')) continue;
      separator_ = candidate;
      return;
    }
}

/// If the first line contains numbers, takes the column names from the comment above it, as in
/// files written by numpy.
void TableText::take_names() {
  if (lines_.empty() || !are_numbers(fields(lines_.front()))) return;
  const TableLine numbers = lines_.front();
  lines_.insert(lines_.begin(), comment_);
  find_separator(true);
  const auto names = split(lines_.front().text, separator_);
  if (names && !are_numbers(*names) && names->size() == fields(numbers).size()) return;
  fail(numbers, "must be a line of column names, but contains numbers");
}

std::vector<std::string> TableText::fields(const TableLine& line) const {
  // A tab before the first field or after the last one delimits an empty field.
  const auto found = split(separator_ == '\t' ? line.text : trimmed(line.text), separator_);
  if (!found) fail(line, "quotation marks must be around whole fields, on one line");
  return *found;
}

void TableText::fail(const TableLine& line, const std::string& what) const {
  throw InputError(path_ + ", line " + std::to_string(line.number) + ": " + what);
}

}  // namespace flatspeckle
