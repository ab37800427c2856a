#include "apps/options.h"

#include <cstdint>
#include <optional>
#include <vector>

#include <CLI/CLI.hpp>

namespace flatspeckle::apps {

template <typename Value>
void Options::add(const std::string& flag, Value& value, const std::string& description) {
  app_.add_option(flag, value, description);
}

template <typename Value>
void Options::add_with_default(const std::string& flag, Value& value,
                               const std::string& description) {
  add(flag, value, description);
  app_.get_option(flag)->capture_default_str();
}

void Options::add_flag(const std::string& flag, bool& value, const std::string& description) {
  app_.add_flag(flag, value, description);
}

void Options::describe(const std::string& flag, const std::string& description) {
  app_.get_option(flag)->description(description);
}

void Options::keep_out_of_scene_file(const std::string& flag) {
  app_.get_option(flag)->configurable(false);
}

void Options::remove(const std::string& flag) {
  app_.remove_option(app_.get_option(flag));
}

// The kinds of values that subcommands have.
using Text = const std::string&;
template void Options::add(Text, int&, Text);
template void Options::add_with_default(Text, int&, Text);
template void Options::add(Text, double&, Text);
template void Options::add_with_default(Text, double&, Text);
template void Options::add(Text, std::int64_t&, Text);
template void Options::add_with_default(Text, std::int64_t&, Text);
template void Options::add(Text, std::string&, Text);
template void Options::add_with_default(Text, std::string&, Text);
template void Options::add(Text, std::optional<double>&, Text);
template void Options::add(Text, std::vector<double>&, Text);
template void Options::add(Text, std::optional<std::int64_t>&, Text);
template void Options::add(Text, std::vector<std::int64_t>&, Text);
template void Options::add(Text, std::optional<std::string>&, Text);
template void Options::add(Text, std::vector<std::string>&, Text);

}  // namespace flatspeckle::apps
