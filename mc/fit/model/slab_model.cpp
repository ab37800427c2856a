#include "mc/fit/model/slab_model.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "mc/fit/task/curve_values.h"
#include "mc/jobs/flux_job.h"
#include "mc/slab/slab_covariance.h"
#include "mc/slab/slab_flux.h"

namespace flatspeckle::mc {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

void put(VectorXd& all, Index first, const std::vector<double>& values) {
  std::copy(values.begin(), values.end(), all.data() + first);
}

}  // namespace

SlabModel::SlabModel(std::vector<Curve> curves, const Media& media) : curves_(std::move(curves)) {
  for (std::size_t i = 0; i < curves_.size(); ++i) {
    if (media[i].scene.domain.kind != Domain::Kind::slab)
      throw InputError("domain", "box",
                       "the transport model requires domain = slab; boxes require method = mc");
    if (curves_[i].moving() && !media[i].spec.only_diffuses())
      throw InputError("velocity_x, velocity_z, shear: require method = mc");
    first_.push_back(size_);
    size_ += static_cast<Index>(curves_[i].entries.size());
    auto group =
        std::ranges::find_if(groups_, [&](const Group& one) { return can_share(one, media, i); });
    if (group == groups_.end()) group = groups_.insert(group, empty_group(media, i));
    group->curves.push_back(i);
    if (group->distances) group->distances->add(curves_[i], first_.back());
  }
}

SlabModel::Group SlabModel::empty_group(const Media& media, std::size_t curve) const {
  const bool flux = is_flux(curves_[curve].observable);
  if (curves_[curve].distances) return {.distances = DistanceCurves()};
  return {flux, !flux && needs_reversed(media[curve].scene), curves_[curve].delays};
}

bool SlabModel::can_share(const Group& group, const Media& media, std::size_t curve) const {
  const Scene &first = media[group.curves.front()].scene, &scene = media[curve].scene;
  if (group.distances || curves_[curve].distances)
    return group.distances && curves_[curve].distances &&
           first.domain.depth == scene.domain.depth &&
           curves_[group.curves.front()].moving() == curves_[curve].moving();
  const bool flux = is_flux(curves_[curve].observable);
  return group.delays == curves_[curve].delays && first.domain.depth == scene.domain.depth &&
         first.k == scene.k && first.faces == scene.faces && group.flux == flux &&
         (flux || (!has_near_endpoints(first.request) && !has_near_endpoints(scene.request) &&
                   group.reversed == needs_reversed(scene)));
}

bool SlabModel::reversed() const {
  return std::ranges::any_of(groups_, &Group::reversed);
}

std::vector<int> SlabModel::resolution() const {
  std::vector<int> all{resolution_.order, resolution_.modes};
  for (const Group& group : groups_)
    if (group.distances) all.push_back(group.distances->degree());
  return all;
}

double SlabModel::refine(const Media& media, const VectorXd& errors, double share,
                         const std::function<void()>& solved) {
  constexpr int most = 30;
  double of_distances = 0;
  for (Group& group : groups_)
    if (group.distances)
      of_distances = std::max(of_distances, group.distances->refine(media[group.curves.front()],
                                                                    errors, share, solved));
  if (std::ranges::all_of(groups_, [](const Group& one) { return one.distances.has_value(); }))
    return of_distances;
  VectorXd found = solution(media, resolution_);
  while (true) {
    solved();
    const Resolution next{Resolution::next(resolution_.order), Resolution::next(resolution_.modes)};
    const VectorXd finer = solution(media, next);
    const double change = (finer - found).cwiseQuotient(errors).cwiseAbs().maxCoeff();
    if (change < share || next.order > most) return std::max(change, of_distances);
    resolution_ = next;
    found = finer;
  }
}

VectorXd SlabModel::solution(const Media& media, const Resolution& at) const {
  VectorXd all(size_);
  for (const Group& group : groups_)
    if (group.distances)
      group.distances->solve(media[group.curves.front()], all);
    else
      group.flux ? solve_flux(group, media, all) : solve_fields(group, media, at, all);
  return all;
}

void SlabModel::solve_fields(const Group& group, const Media& media, const Resolution& at,
                             VectorXd& all) const {
  // A hundredth of this relative tolerance applies to the integrals over paths with two
  // scatterings.
  constexpr double tolerance = 1e-4;
  const Medium& first = media[group.curves.front()];
  const Scene joint = joint_scene(media, group.curves);
  const Refinement once{.tolerance = tolerance, .fixed = at};
  const auto solve = [&](const FieldChange& change) {
    return slab_covariance(joint, group.reversed, once, change);
  };
  std::vector<Refined> found{solve({})};
  for (const double delay : group.delays)
    found.push_back(solve({.delay = first.spec.diffusion * delay}));
  std::size_t entry = 0;
  for (const std::size_t i : group.curves) {
    const CovarianceRequest& request = media[i].scene.request;
    const std::size_t count = request.entries.size();
    std::vector<Complex> entries;
    for (const Refined& one : found) {
      const auto own = std::span(one.value).subspan(entry, count);
      entries.insert(entries.end(), own.begin(), own.end());
    }
    put(all, first_[i], observed(curves_[i], media[i].spec.beta, request, entries));
    entry += count;
  }
}

void SlabModel::solve_flux(const Group& group, const Media& media, VectorXd& all) const {
  const Refinement precise{1e-5};
  constexpr std::size_t bins = 1, shares = flux_shares + bins;
  Scene joint = media[group.curves.front()].scene;
  Lights& lights = joint.request.lights;
  lights.clear();
  const auto place = [&](const Light& light) {
    const auto found = std::ranges::find(lights, light);
    if (found != lights.end()) return found - lights.begin();
    lights.push_back(light);
    return std::ssize(lights) - 1;
  };
  std::vector<std::size_t> places;
  for (const std::size_t i : group.curves)
    for (const std::size_t entry : curves_[i].entries)
      places.push_back(
          shares * static_cast<std::size_t>(place(media[i].scene.request.lights[entry])) +
          (curves_[i].observable == Observable::reflectance ? reflected : transmitted));
  const Refined found = slab_flux(joint, bins, precise);
  auto next = places.begin();
  for (const std::size_t i : group.curves)
    for (Index j = 0; j < std::ssize(curves_[i].entries); ++j, ++next)
      all[first_[i] + j] = found.value[*next].real();
}

}  // namespace flatspeckle::mc
