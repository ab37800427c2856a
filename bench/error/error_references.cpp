#include <map>
#include <sstream>

#include "bench/error/error_modules.h"

namespace flatspeckle::bench {

extern const char* const
    error_reference_table;  // contents of data/error_references.txt, compiled in by CMake

namespace {

std::map<std::string, ErrorReference> read_table(std::istream& table) {
  std::map<std::string, ErrorReference> references;
  ErrorReference* current = nullptr;
  for (std::string line; std::getline(table, line);) {
    if (line.empty() || line.front() == '#') continue;
    std::istringstream fields(line);
    if (line.find('|') == std::string::npos) {
      double real = 0, imaginary = 0;
      fields >> real >> imaginary;
      current->value.emplace_back(real, imaginary);
      continue;
    }
    std::string name, error, how;
    std::getline(fields, name, '|');
    std::getline(fields, error, '|');
    std::getline(fields, how);
    current = &references[name];
    *current = {{}, std::stod(error), how};
  }
  return references;
}

}  // namespace

ErrorReference stored_reference(const std::string& name) {
  static const auto references = [] {
    std::istringstream table(error_reference_table);
    return read_table(table);
  }();
  return references.at(name);
}

}  // namespace flatspeckle::bench
