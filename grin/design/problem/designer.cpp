#include "grin/design/problem/designer.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <Eigen/Core>

#include "core/run/stopwatch.h"
#include "core/session/journal.h"
#include "grin/design/descent/least_squares.h"

namespace flatspeckle::grin::design {

namespace {

/// Calls use(member) for each member of the state that is saved, in a fixed order.
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

Eigen::Map<const Eigen::VectorXd> vector_of(const std::vector<double>& values) {
  return {values.data(), std::ssize(values)};
}

double share_of_zeros(const std::vector<double>& residuals) {
  return static_cast<double>(std::ranges::count(residuals, 0.0)) /
         static_cast<double>(residuals.size());
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
  throw InputError(std::string("resume: ") + error.what() + "; remove the file to start again");
}

Designer::Designer(const DesignScene& scene)
    : scene_(scene),
      seen_(scene.design_target->task(scene.walk, false)),
      held_out_(scene.design_target->task(scene.walk, true)) {}

FieldForm Designer::form(const DesignState& state) const {
  FieldForm form = scene_.start.form;
  for (int i = 0; i < state.level; ++i)
    form = std::visit([](const auto& f) -> FieldForm { return f.finer(); }, form);
  return form;
}

Search Designer::search_in(const FieldForm& form) const {
  Search search{bounds_of(form, scene_.start.least_index, scene_.start.most_index)};
  if (const auto* box = std::get_if<BoxForm>(&form); box && scene_.start.most_gradient)
    // The magnitude of a gradient is at most that of its largest component times the root of 3
    search.bounds.most_difference =
        *scene_.start.most_gradient * box->grid().spacing[0] / std::sqrt(3.0);
  const auto& extent = shape_of(form).extent;
  // Search steps for a radial profile need not be smooth, because rays cross all of its radii
  if (extent[0] == 1) search.smooth_damping = 0;
  return search;
}

DesignState Designer::begin() {
  DesignState state;
  const FieldForm& form = scene_.start.form;
  state.search = begin_search({*seen_.rays, *seen_.objective, form}, search_in(form),
                              scene_.start.coefficients);
  state.search.roughness = scene_.roughness;
  note(state);
  return state;
}

void Designer::note(DesignState& state) const {
  state.history.rms.push_back(std::sqrt(state.search.loss));
  state.history.traces.push_back(static_cast<double>(state.search.traces));
  state.history.cpu_s.push_back(state.cpu_before + process_cpu_seconds());
  state.history.coefficients.push_back(state.search.coefficients.size());
}

void Designer::refine(DesignState& state) {
  FinerField fine = finer(form(state), state.search.coefficients);
  const Search search = search_in(fine.form);
  search.bounds.hold(fine.coefficients);
  state.search.coefficients = std::move(fine.coefficients);
  state.search.damping = search.first_damping;
  state.search.loss =
      Objective(*seen_.rays, *seen_.objective, fine.form).loss(state.search.coefficients);
  ++state.search.traces;
  state.slow_steps = 0;
  ++state.level;
}

/// Lowers the weight of the roughness and returns true, unless lowering it last time did not reduce
/// the residual, which is then due to the spacing of the knots of the field. Early in the search
/// the weight is always lowered, because a large weight prevents any decrease of the residual.
bool Designer::smoothes_on(DesignState& state) const {
  constexpr double least = 1e-12, factor = 0.3;
  if (!scene_.has_noise || state.search.roughness < least) return false;
  const double rms = std::sqrt(state.search.loss);
  const double last = std::exchange(state.rms_as_smooth, rms);
  if (rms < 0.5 * state.history.rms.front() && rms > 0.98 * last) return false;
  state.search.roughness *= factor;
  state.search.damping = search_in(form(state)).first_damping;
  state.slow_steps = 0;
  return true;
}

/// Whether the residuals are below the integration error, so that the search only cancels this
/// error. The integration error is computed again each time the residual has halved.
bool Designer::leans_on_steps(DesignState& state) {
  const double now = std::sqrt(state.search.loss);
  if (now > 0.5 * state.rms_by_half_steps) return false;
  const auto by_half = rms(seen_, seen_.rays->trace(form(state), state.search.coefficients, 2));
  // A trace with half steps counts as two traces; a third one restores the state of the rays
  state.search.traces += 3;
  state.rms_by_half_steps = by_half.value_or(now);
  return state.rms_by_half_steps > 2 * now;
}

void Designer::advance(DesignState& state) {
  const bool is_last = state.level + 1 == scene_.start.levels;
  // A step of the search is slow if the residual remains above this fraction of its previous value
  const double slow = is_last ? 1 - scene_.tolerance : 0.7;
  const int most_slow_steps = scene_.has_noise ? 1 : 2;
  const FieldForm form = this->form(state);
  const LeastSquares search({*seen_.rays, *seen_.objective, form}, search_in(form));
  const double before = state.search.loss;
  const SearchStep step = search.advance(state.search);
  const double rms = std::sqrt(state.search.loss);
  constexpr double rounding = 1e-9;  // relative to the residual at the start
  state.stalled = step == SearchStep::stalled && rms > rounding * state.history.rms.front();
  const bool is_enough = rms <= scene_.target;
  const bool gained = step == SearchStep::better && rms < slow * std::sqrt(before);
  state.slow_steps = gained ? 0 : state.slow_steps + 1;
  const bool is_settled = step != SearchStep::better;
  const bool gains_little = state.slow_steps == most_slow_steps;
  const bool leans = !is_settled && !gains_little && is_last && scene_.tolerance > 0 &&
                     rms > 0.8 * std::sqrt(before) && leans_on_steps(state);
  const bool is_slow = is_settled || gains_little || leans;
  note(state);
  const int level = state.level + 1, share = scene_.iterations * level / scene_.start.levels;
  const bool is_spent = static_cast<int>(state.history.rms.size()) > share;
  const bool may_end = is_last && (is_enough || (is_slow && !smoothes_on(state)));
  state.ended = (is_spent && is_last) || may_end;
  if (state.ended)
    state.ended_by = is_enough      ? "target"
                     : is_settled   ? "no step reduces the residual"
                     : leans        ? "the residual is below the integration error of the rays"
                     : gains_little ? "tolerance"
                                    : "iterations";
  if (!state.ended && !is_last && (is_slow || is_enough || is_spent)) refine(state);
}

std::optional<double> Designer::rms(DesignTask& task,
                                    const std::optional<std::vector<double>>& measurements) {
  if (!measurements) return std::nullopt;
  double sum = 0;
  for (const double r : task.objective->residuals(*measurements)) sum += r * r;
  return std::sqrt(sum / static_cast<double>(task.rays->rays()));
}

DesignCheck Designer::check(const DesignState& state) {
  const auto& coefficients = state.search.coefficients;
  const auto rms_by = [&](DesignTask& task, int parts) {
    return rms(task, task.rays->trace(form(state), coefficients, parts));
  };
  DesignCheck check;
  check.seen = rms_by(seen_, 1);
  check.unseen = unseen(state);
  check.derivatives = derivatives(state);
  check.seen_half_step = rms_by(seen_, 2);
  check.held_out = rms_by(held_out_, 1);
  check.start_held_out =
      rms(held_out_, held_out_.rays->trace(scene_.start.form, scene_.start.coefficients))
          .value_or(0);
  check.measurements = held_out_.rays->trace(form(state), coefficients, 2);
  check.held_out_half_step = rms(held_out_, check.measurements);
  if (check.measurements)
    check.in_place = share_of_zeros(held_out_.objective->residuals(*check.measurements));
  return check;
}

/// Returns the number of free coefficients within the field for which is(number of the coefficient,
/// bounds) is true.
template <class Is>
std::size_t Designer::count_free(const DesignState& state, const Is& is) const {
  const FieldForm form = this->form(state);
  const Bounds bounds = bounds_of(form, scene_.start.least_index, scene_.start.most_index);
  std::size_t count = 0;
  for (std::size_t i = 0; i < state.search.coefficients.size(); ++i)
    if (is_within(form, i) && bounds.least[i] < bounds.most[i] && is(i, bounds)) ++count;
  return count;
}

std::size_t Designer::at_bounds(const DesignState& state) const {
  const auto& values = state.search.coefficients;
  return count_free(state, [&](std::size_t i, const Bounds& bounds) {
    return values[i] <= bounds.least[i] || values[i] >= bounds.most[i];
  });
}

std::size_t Designer::unseen(const DesignState& state) {
  const auto& values = state.search.coefficients;
  const auto measurements = seen_.rays->trace(form(state), values);
  if (!measurements) return 0;
  std::vector<double> squares(values.size());
  seen_.rays->linearised().squares(std::vector<double>(measurements->size(), 1.0), squares);
  return count_free(state, [&](std::size_t i, const Bounds&) { return squares[i] == 0; });
}

/// Compares the derivatives computed with reversed rays with finite differences, along the gradient
/// of the sum of all measurements. Finite differences with two step sizes are extrapolated; their
/// difference is an estimate of the error. Returns nullopt if a ray is lost or no ray depends on
/// the coefficients.
std::optional<Invariant> Designer::derivatives(const DesignState& state) {
  constexpr double distance = 1e-4, of_rounded_rows = 1e-3;
  const FieldForm form = this->form(state);
  const std::vector<double>& at = state.search.coefficients;
  const auto there = seen_.rays->trace(form, at);
  if (!there) return std::nullopt;
  const RayRows rows = seen_.rays->linearised();
  std::vector<double> along(at.size()), change(there->size());
  rows.transposed(std::vector<double>(there->size(), 1.0), along);
  double largest = 0;
  for (const double each : along) largest = std::max(largest, std::abs(each));
  if (!(largest > 0)) return std::nullopt;
  for (double& each : along) each /= largest;
  rows.times(along, change);
  const auto difference_quotient = [&](double h) -> std::optional<Eigen::VectorXd> {
    std::vector<double> ahead = at, behind = at;
    for (std::size_t i = 0; i < at.size(); ++i) {
      ahead[i] += h * along[i];
      behind[i] -= h * along[i];
    }
    const auto after = seen_.rays->trace(form, ahead), before = seen_.rays->trace(form, behind);
    if (!after || !before) return std::nullopt;
    return (vector_of(*after) - vector_of(*before)) / (2 * h);
  };
  const auto coarse = difference_quotient(2 * distance), fine = difference_quotient(distance);
  if (!coarse || !fine) return std::nullopt;
  const Eigen::VectorXd found = *fine + (*fine - *coarse) / 3;
  const double size = found.norm();
  if (!(size > 0)) return std::nullopt;
  return Invariant{(vector_of(change) - found).norm() / size,
                   of_rounded_rows + (*fine - *coarse).norm() / size};
}

std::optional<double> focal_length(const DesignScene& scene, const Designer& designer,
                                   const DesignState& state) {
  // Closer to the axis, the residual of the rays would be large relative to the height
  constexpr double share = 0.1;
  const FieldForm form = designer.form(state);
  const auto hull = hull_of(form);
  const Sphere* ball = hull ? std::get_if<Sphere>(&*hull) : nullptr;
  if (!ball) return std::nullopt;
  const double height = share * ball->radius;
  const double back = std::sqrt(ball->radius * ball->radius - height * height);
  // Grazes no surface: the ray ends on the ball, where the index is that of the host
  const DesignRay ray{ball->centre + Vec3(height, 0, -back), Vec3::UnitZ(), Surface(*ball)};
  const FollowedRay end = std::visit(
      [&](const auto& of) {
        return follow<Pefrl>(of.field(state.search.coefficients), ray, scene.walk);
      },
      form);
  const double sine = -end.state.v[0] / end.state.v.norm();
  return end.lost || !(sine > 0) ? std::nullopt : std::optional(height / sine);
}

}  // namespace flatspeckle::grin::design
