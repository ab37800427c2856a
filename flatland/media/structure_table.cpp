#include "flatland/media/structure_table.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <sstream>

#include "core/contract.h"
#include "core/error.h"
#include "core/result/guarded_read.h"
#include "core/result/result_reader.h"
#include "flatland/media/structure_factor.h"

namespace flatspeckle {

namespace {

/// q is in inverse units of the scene's length, so a file of another scale must not pass.
void check_same(const std::string& path, const std::string& what, double measured, double scene) {
  constexpr double rounding = 0.02;
  if (std::abs(measured - scene) <= rounding * scene) return;
  std::ostringstream accepted;
  accepted << "has " << what << ' ' << measured << ", the scene " << scene
           << "; measure it with the scene's own disks";
  throw InputError("structure", path, accepted.str());
}

}  // namespace

StructureTable::StructureTable(std::string origin, std::vector<double> q,
                               std::vector<double> values)
    : origin_(std::move(origin)), q_(std::move(q)), values_(std::move(values)) {
  FS_EXPECT(q_.size() == values_.size() && std::is_sorted(q_.begin(), q_.end()));
}

double StructureTable::operator()(double q) const {
  if (independent() || q > q_.back()) return 1;
  const auto above = std::upper_bound(q_.begin(), q_.end(), q);
  if (above == q_.begin()) return values_.front();
  const auto i = static_cast<std::size_t>(above - q_.begin());
  if (i == q_.size()) return values_.back();
  const double t = (q - q_[i - 1]) / (q_[i] - q_[i - 1]);
  return (1 - t) * values_[i - 1] + t * values_[i];
}

std::string StructureTable::text() const {
  std::ostringstream text;
  text.precision(std::numeric_limits<double>::max_digits10);
  for (std::size_t i = 0; i < q_.size(); ++i) text << q_[i] << ',' << values_[i] << '\n';
  return text.str();
}

double DiskSpacing::packing() const {
  return density * std::numbers::pi * contact * contact / 4;
}

StructureTable hard_disk_structure(const DiskSpacing& disks, double q_max) {
  const double packing = disks.packing();
  if (packing > 0.7)
    throw InputError("structure", "hard_disks",
                     "the fluid of hard disks freezes near packing fraction 0.7");
  // Of q times diameter: linear between the nodes, to 1e-4 at packing 0.3. Beyond the last S is 1
  // to 6e-3 eta g(contact), which is 0.2 % at packing 0.2.
  constexpr double step = 0.05, last = 100;
  q_max = std::min(q_max, last / disks.contact);
  const HardDiskFluid fluid(packing, disks.contact);
  const auto steps = static_cast<std::size_t>(std::ceil(q_max * disks.contact / step));
  std::vector<double> q, values;
  for (std::size_t i = 0; i <= steps; ++i) {
    q.push_back(q_max * static_cast<double>(i) / static_cast<double>(steps));
    values.push_back(fluid.structure_factor(q.back()));
  }
  std::ostringstream origin;
  origin << "of hard disks, packing fraction " << packing;
  return {origin.str(), std::move(q), std::move(values)};
}

namespace {

StructureTable read_table(const std::string& path, const DiskSpacing& disks) {
  const ResultReader file(path);
  for (const char* name : {"q", "structure_factor"})
    if (!file.has(name))
      throw InputError("structure", path,
                       std::string("has no dataset ") + name +
                           "; must be none, hard_disks or a file that place --structure wrote");
  const auto measured = [&](const char* name) { return file.attribute<double>("/", name); };
  const double area = measured("width") * measured("depth");
  const auto count = static_cast<double>(file.attribute<std::uint64_t>("/", "count"));
  const double density = count / area;
  // packing_fraction leaves the gap out
  const double diameter =
      std::sqrt(4 * measured("packing_fraction") / (std::numbers::pi * density));
  check_same(path, "density", density, disks.density);
  check_same(path, "contact distance", diameter + measured("min_gap"), disks.contact);
  auto q = file.dataset<double>("q"), values = file.dataset<double>("structure_factor");
  const bool rising = std::adjacent_find(q.begin(), q.end(), std::not_fn(std::less<>{})) == q.end();
  const bool possible =
      std::all_of(values.begin(), values.end(), [&](double s) { return s > 0 && s <= count; });
  if (q.size() != values.size() || q.empty() || !rising || !(q.front() >= 0) ||
      !std::isfinite(q.back()) || !possible)
    throw InputError("structure", path,
                     "must hold values above 0 and at most the count of disks, over rising q");
  return {"measured, " + path, std::move(q), std::move(values)};
}

}  // namespace

StructureTable read_structure(const std::string& path, const DiskSpacing& disks) {
  if (std::error_code none; !std::filesystem::exists(path, none))
    throw InputError("structure", path,
                     "must be none, hard_disks or a file that place --structure wrote");
  return guarded_read(path, [&] { return read_table(path, disks); });
}

}  // namespace flatspeckle
