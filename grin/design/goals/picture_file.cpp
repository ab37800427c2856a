#include "grin/design/goals/picture_file.h"

#include <algorithm>
#include <fstream>
#include <sstream>

#include "core/error.h"
#include "core/keys/number_text.h"

namespace flatspeckle::grin::design {

namespace {

std::vector<double> numbers_of(std::string line, const std::string& where) {
  std::ranges::replace(line, ',', ' ');
  std::istringstream text(line);
  std::vector<double> numbers;
  for (std::string word; text >> word;) {
    const auto value = read_number(word);
    if (!value || !(*value >= 0 && *value <= 1e50))
      throw InputError(where + ": '" + word + "' must be a number from 0 to 1e50");
    numbers.push_back(*value);
  }
  return numbers;
}

}  // namespace

Picture read_picture(const std::string& path, double width) {
  std::ifstream file(path);
  if (!file) throw InputError("pictures", path, "cannot be read");
  Picture picture{width, 0, {}};
  std::size_t rows = 0, columns = 0, number = 0;
  for (std::string line; std::getline(file, line);) {
    ++number;
    const auto row = numbers_of(line, path + ", line " + std::to_string(number));
    if (row.empty()) continue;
    if (rows++ == 0) columns = row.size();
    if (row.size() != columns)
      throw InputError("pictures", path,
                       "must have rows of one length; line " + std::to_string(number) + " has " +
                           std::to_string(row.size()) + " numbers, the first row " +
                           std::to_string(columns));
    picture.values.insert(picture.values.end(), row.begin(), row.end());
  }
  if (rows != columns || rows < 4 || rows > 4096)
    throw InputError("pictures", path,
                     "must be a square of 4 to 4096 rows of numbers; has " + std::to_string(rows) +
                         " rows of " + std::to_string(columns));
  if (!(std::ranges::max(picture.values) > 0))
    throw InputError("pictures", path, "must not be all dark");
  picture.pixels = static_cast<int>(rows);
  return picture;
}

}  // namespace flatspeckle::grin::design
