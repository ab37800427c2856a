#include <algorithm>
#include <cctype>
#include <chrono>
#include <exception>
#include <filesystem>
#include <iostream>
#include <map>
#include <new>
#include <thread>

#include "apps/subcommands.h"
#include "core/error.h"
#include "core/result/version.h"
#include "core/run/ranks.h"

namespace {

using namespace flatspeckle;
using namespace flatspeckle::apps;

const char* const usage =
    R"(flatspeckle - speckle statistics: path-space Monte Carlo checked by an exact wave solver

  flatspeckle SUBCOMMAND [--config SCENE.toml] [--key value ...] --out FILE.h5

  place        a placement of scatterers, drawn and written as CSV
  solve        exact fields of one placement of scatterers
  covariance   covariance and intensity of the speckle of a scene, by Monte Carlo or exactly
  validate     both methods on one scene, compared entry by entry
  flux         reflected, transmitted and absorbed power, intensity only
  sweep        memory-effect curves over grids or lists of g, albedo, optical depth, radius, index
  merge        the points of a sweep that ran in shares, as one result
  field        speckle fields drawn with the covariance of a scene, also over tilts of the light
  trace        rays and the curves between two points in a gradient-index field
  render       pictures of scattering media with a gradient index: 3D refractive path tracing
  datasets     what result files hold, as in docs/format.md
  bench        what accuracy costs, where it breaks, what plans leave out: error, stability, plan

  flatspeckle SUBCOMMAND --help lists the keys; flatspeckle --version tells the version.
  Exit status: 0 done, 2 bad input, 3 stopped before the target error was reached,
  4 input or output failed, 5 a row of a benchmark failed, 75 interrupted and resumable.
)";

int run(const Arguments& arguments) {
  static const std::map<std::string, int (*)(const Arguments&)> subcommands = {
      {"place", place},   {"solve", solve},       {"covariance", covariance},
      {"flux", flux},     {"validate", validate}, {"sweep", sweep},
      {"field", field},   {"merge", merge},       {"trace", trace},
      {"render", render}, {"bench", bench},       {"datasets", datasets}};
  const std::string word = arguments.size() > 1 ? arguments[1] : "--help";
  if (word == "--help" || word == "-h" || word == "help") {
    std::cout << usage;
    return ExitStatus::done;
  }
  if (word == "--version") {
    std::cout << "flatspeckle " << version() << " (" << git_commit() << ")\n";
    return ExitStatus::done;
  }
  const auto subcommand = subcommands.find(word);
  if (subcommand == subcommands.end())
    throw InputError(
        "subcommand", word,
        "must be one of bench covariance datasets field flux merge place render solve sweep trace "
        "validate");
  if (word != "sweep" && launched_ranks().size > 1)
    throw InputError("subcommand", word, "runs as one process; of these, sweep alone takes many");
  return subcommand->second(arguments);
}

/// One line, whatever a file or flag that the message quotes may hold. Of processes that all find
/// the same fault in what they were given, the first speaks for all.
int fail(std::string what, int status) {
  if (status == ExitStatus::bad_input && launched_ranks().rank > 0) {
    std::this_thread::sleep_for(std::chrono::seconds(1));  // or it would be ended before it speaks
    return status;
  }
  std::replace_if(
      what.begin(), what.end(), [](unsigned char c) { return std::iscntrl(c); }, '?');
  std::cerr << "flatspeckle: " << what << '\n';
  return status;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run({argv, argv + argc});
  } catch (const InputError& error) {
    return fail(error.what(), ExitStatus::bad_input);
  } catch (const IoError& error) {
    return fail(error.what(), ExitStatus::io_failed);
  } catch (const std::filesystem::filesystem_error& error) {
    return fail(error.what(), ExitStatus::io_failed);
  } catch (const std::bad_alloc&) {
    return fail("this scene needs more memory than there is", ExitStatus::bad_input);
  } catch (const std::exception& error) {
    return fail(error.what(), 1);
  }
}
