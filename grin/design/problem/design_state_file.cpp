#include "grin/design/problem/design_state_file.h"

#include "core/session/journal.h"

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
  use(state.history.rms);
  use(state.history.traces);
  use(state.history.cpu_s);
  use(state.history.coefficients);
}

}  // namespace

std::filesystem::path state_path(const std::filesystem::path& out) {
  return out.string() + ".state";
}

void save_state(const std::filesystem::path& path, const std::string& identity,
                const DesignState& state) {
  ByteWriter record;
  each_member(state, [&](const auto& member) { record.put(member); });
  keep_record(path, identity, record.take(), Durable::no);
}

bool holds(const std::filesystem::path& path, const std::string& identity) try {
  return kept_record(path, identity, "search").has_value();
} catch (const InputError&) {
  return false;
}

std::optional<DesignState> read_state(const std::filesystem::path& path,
                                      const std::string& identity) try {
  const auto kept = kept_record(path, identity, "search");
  if (!kept) return std::nullopt;
  ByteReader record(*kept);
  DesignState state;
  each_member(state, [&](auto& member) { record.get(member); });
  if (!state.history.cpu_s.empty()) state.cpu_before = state.history.cpu_s.back();
  return state;
} catch (const InputError& error) {
  throw InputError(std::string("resume: ") + error.what() + "; remove it to begin afresh");
}

}  // namespace flatspeckle::grin::design
