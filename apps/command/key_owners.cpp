#include "apps/command/key_owners.h"

#include <iostream>
#include <sstream>

#include "apps/command/subcommands.h"

namespace flatspeckle::apps {

namespace {

/// Standard output as a text, as long as this lives.
class Captured {
 public:
  Captured() : before_(std::cout.rdbuf(text.rdbuf())) {}
  ~Captured() { std::cout.rdbuf(before_); }
  Captured(const Captured&) = delete;

  std::stringstream text;

 private:
  std::streambuf* before_;
};

}  // namespace

std::map<std::string, std::vector<std::string>> key_owners() {
  std::map<std::string, std::vector<std::string>> owners;
  for (const SubcommandEntry& entry : subcommands()) {
    if (std::string(entry.name) == "keys") continue;
    Captured printed;
    entry.run({"flatspeckle", entry.name, "--keys=names"});
    for (std::string name; printed.text >> name;) owners[name].emplace_back(entry.name);
  }
  return owners;
}

}  // namespace flatspeckle::apps
