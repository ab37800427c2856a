#include "grin/design/scene/design_state_file.h"

#include <fstream>
#include <iterator>

#include "core/result/atomic_file.h"
#include "core/result/byte_stream.h"
#include "core/result/sealed_file.h"
#include "core/session/identity.h"

namespace flatspeckle::grin::design {

namespace {

/// put(member) or get(member) of all of them, in one order.
template <class State, class Use>
void each_member(State& state, const Use& use) {
  use(state.level);
  use(state.slow_steps);
  use(state.rms_as_smooth);
  use(state.rms_by_half_steps);
  use(state.search.coefficients);
  use(state.search.damping);
  use(state.search.roughness);
  use(state.search.loss);
  use(state.search.traces);
  use(state.search.memory);
  use(state.history.rms);
  use(state.history.traces);
  use(state.history.cpu_s);
  use(state.history.coefficients);
}

std::vector<std::byte> bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::vector<char> text{std::istreambuf_iterator<char>(file), {}};
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

}  // namespace

std::filesystem::path state_path(const std::filesystem::path& out) {
  return out.string() + ".state";
}

void save_state(const std::filesystem::path& path, const std::string& identity,
                const DesignState& state) {
  ByteWriter writer;
  writer.put(identity);
  each_member(state, [&](const auto& member) { writer.put(member); });
  auto bytes = writer.take();
  seal(bytes);
  replace_file(path, bytes, Durable::no);
}

bool holds(const std::filesystem::path& path, const std::string& identity) {
  if (!is_sealed(path)) return false;
  const auto bytes = bytes_of(path);
  return ByteReader(bytes).get<std::string>() == identity;
}

std::optional<DesignState> read_state(const std::filesystem::path& path,
                                      const std::string& identity) {
  if (!std::filesystem::exists(path)) return std::nullopt;
  if (!is_sealed(path))
    throw InputError("resume: " + path.string() + " is damaged; remove it to begin afresh");
  const auto bytes = bytes_of(path);
  ByteReader reader(bytes);
  if (const auto found = reader.get<std::string>(); found != identity)
    throw InputError("resume: " + path.string() + " holds another search (" +
                     first_difference(found, identity) +
                     "); scene, files and program version must be the same");
  DesignState state;
  each_member(state, [&](auto& member) { reader.get(member); });
  if (!state.history.cpu_s.empty()) state.cpu_before = state.history.cpu_s.back();
  return state;
}

}  // namespace flatspeckle::grin::design
