#include "wave_solver/equations/basis_orders.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "core/error.h"
#include "core/numbers/complex.h"
#include "wave_solver/equations/neighbours.h"
#include "wave_solver/equations/rim_waves.h"

namespace flatspeckle::wave {

namespace {

constexpr double nowhere = std::numeric_limits<double>::infinity();

// Number of orders above oscillating_order() up to which pairs are solved in the first attempt.
constexpr int first_orders = 16;

// Whether the electrostatic image that a charge has in the disk is stronger than the charge itself.
// For index m the ratio of image to charge is (m^2 - 1) / (m^2 + 1). Waves of high orders (gap
// plasmons) then propagate along a narrow gap.
bool amplifies_images(const Scatterer& disk) {
  return disk.kind == Scatterer::Kind::te && (disk.index * disk.index).real() < 0;
}

// Returns the number of orders above oscillating_order() up to which pairs are solved, before
// bounded_order() is used instead. Hard disks need few orders, because their images add up, so that
// the bound is sharp. Gap plasmons need many, because no bound exists for them.
int most_paired(const Scatterer& disk, bool plasmons) {
  if (plasmons) return 1024;
  return disk.kind == Scatterer::Kind::hard ? 64 : 512;
}

// Returns the safety factor that accounts for scatterers outside a pair; its values were measured
// on pairs and clusters. It grows with the size and, in the plane, with the index of a scatterer,
// because modes of such scatterers resonate collectively.
double safety(const Scatterer& scatterer, double k, Radial kind) {
  const double x = k * scatterer.radius;
  const bool space = kind == Radial::spherical;
  if (!scatterer.is_penetrable()) return space ? 10 + x : 20 + 2 * x;
  const double contrast = std::max(1.0, (scatterer.index * scatterer.index).real() - 1);
  return (8 + 2 * x) * (space ? 1 : contrast * contrast);
}
constexpr double single_safety = 3;
constexpr double near_safety = 5;

// Returns the safety factor for two effects that the bound of bounded_order() does not include:
// many orders add up, and between hard disks the error grows with k radius.
double bound_safety(const Scatterer& disk, double k) {
  const double x = disk.kind == Scatterer::Kind::hard ? k * disk.radius : 0;
  return 200 * (1 + x * x);
}

bool is_on_rim(const Scatterer& disk, double distance) {
  return distance <= disk.radius * (1 + 1e-9);
}

// Returns log2 |H_n(k distance)|, n = 0 .. order; -infinity if the distance is `nowhere`
// (infinite).
std::vector<double> log_hankel(int order, double k, double distance, Radial kind) {
  std::vector<double> logs(order + 1, -nowhere);
  if (distance == nowhere) return logs;
  const auto h = scaled_hankel(order, k * distance, kind);
  std::transform(h.begin(), h.end(), logs.begin(), [](const auto& h_n) { return log2(abs(h_n)); });
  return logs;
}

constexpr double steps = 8;
constexpr int first_step = -480;  // smaller gaps differ from contact only by rounding
constexpr int last_step = 24;     // larger gaps are treated like this one

// Returns the bipolar coordinate xi of the first disk's rim (nearest_image).
double xi(double radius, double other_radius, double distance) {
  return std::log(nearest_image(radius, other_radius, distance) / radius);
}

}  // namespace

class BasisOrders::Search {
 public:
  Search(double k, double tolerance, const OrderRules& rules)
      : k_(k), tolerance_(tolerance), rules_(rules) {}

  Basis basis(const Placement& placement, std::span<const Vec> sensors, double growth) {
    placement_ = placement;
    sensors_ = sensors;
    met_gap_plasmons_ = false;
    species_of_.clear();
    bool disks = false;
    for (const auto& placed : placement) {
      species_of_.push_back(species_of(placed.scatterer));
      disks = disks || placed.scatterer.is_disk();
    }
    const auto around =
        disks ? neighbours(placement) : std::vector<std::vector<Neighbour>>(placement.size());
    Basis basis;
    for (std::size_t j = 0; j < placement.size(); ++j)
      basis.t.push_back(t_matrix_of(j, around[j], growth));
    basis.gap_plasmons = met_gap_plasmons_;
    return basis;
  }

 private:
  // A distinct scatterer of a placement, with T_n up to the highest order requested so far.
  struct Species {
    Scatterer scatterer;
    double k = 0;
    Radial kind = Radial::cylindrical;
    int oscillating = 0;
    double field = 0;  // square root of the sum of multiplicity(n) |T_n|^2
    std::vector<ScaledComplex> t;
    std::vector<double> log_t;

    void extend(int order) {
      if (static_cast<int>(t.size()) > order) return;
      t = scaled_t_matrix(scatterer, k, order, kind);
      log_t.clear();
      long double sum = 0;
      for (const ScaledComplex& t_n : t) {
        sum += multiplicity(log_t.size()) * std::norm(static_cast<ExtendedComplex>(t_n));
        log_t.push_back(log2(abs(t_n)));
      }
      field = static_cast<double>(std::sqrt(sum));
    }

    // Returns the number of waves of order n that a plane wave excites equally, on average.
    long double multiplicity(std::size_t n) const {
      if (kind == Radial::spherical) return static_cast<long double>(2 * n + 1);
      return n == 0 ? 1 : 2;
    }

    // Returns log2 |RimWave::field| for each order.
    std::vector<double> log_rim(int order) const {
      std::vector<double> logs;
      for (const RimWave& wave : rim_waves(scatterer, k, order, kind))
        logs.push_back(static_cast<double>(std::log2(std::abs(wave.field))));
      return logs;
    }

    std::vector<ScaledComplex> up_to(int order) {
      extend(order);
      return {t.begin(), t.begin() + order + 1};
    }
  };

  // A pair of species, with a gap between their rims of 2^(step/8) times the smaller radius. Gaps
  // are rounded down to such values, so that many pairs share one solution.
  struct Contact {
    std::size_t first = 0, second = 0;
    int step = 0;

    auto operator<=>(const Contact&) const = default;
  };

  std::vector<ScaledComplex> t_matrix_of(std::size_t j, const std::vector<Neighbour>& around,
                                         double growth) {
    if (!placement_[j].scatterer.is_disk()) return species_[species_of_[j]].up_to(0);
    return species_[species_of_[j]].up_to(
        static_cast<int>(std::ceil(growth * order_of(j, around) + 8 * (growth - 1))));
  }

  std::size_t species_of(const Scatterer& scatterer) {
    if (scatterer.is_bulk())
      throw InputError("scatterer", "hg",
                       rules_.kind == Radial::spherical
                           ? "the wave solver requires point, soft, hard or penetrable"
                           : "the wave solver requires point, soft, hard, tm or te");
    const auto known = std::find_if(species_.begin(), species_.end(), [&](const Species& species) {
      return species.scatterer == scatterer;
    });
    const auto index = static_cast<std::size_t>(known - species_.begin());
    if (known == species_.end())
      species_.push_back({scatterer, k_, rules_.kind, oscillating_order(scatterer, k_), 0, {}, {}});
    return index;
  }

  double nearest_sensor(std::size_t j) const {
    double nearest = nowhere;
    for (const Vec& sensor : sensors_)
      nearest = std::min(nearest, length(sensor - placement_[j].position));
    return nearest;
  }

  Contact contact_of(std::size_t j, const Neighbour& neighbour) const {
    const double a = placement_[j].scatterer.radius,
                 b = placement_[neighbour.scatterer].scatterer.disk_radius();
    const double relative = (neighbour.distance - (a + b)) / (b > 0 ? std::min(a, b) : a);
    const double step = std::floor(steps * std::log2(relative));
    return {species_of_[j], species_of_[neighbour.scatterer],
            static_cast<int>(std::clamp<double>(step, first_step, last_step))};
  }

  double distance_of(const Contact& contact) const {
    const double a = species_[contact.first].scatterer.radius,
                 b = species_[contact.second].scatterer.disk_radius();
    return a + b + (b > 0 ? std::min(a, b) : a) * std::exp2(contact.step / steps);
  }

  int order_of(std::size_t j, const std::vector<Neighbour>& around) {
    const double sensor = nearest_sensor(j);
    if (around.empty()) return single_order(species_[species_of_[j]], sensor);
    int order = 0;
    for (const Neighbour& neighbour : around)
      if (may_matter(j, neighbour, order))
        order = std::max(order, pair_order(j, neighbour, sensor));
    return order;
  }

  // Whether a neighbour may require a higher order than `order`. The effect of its images decays as
  // (radius / Neighbour::image)^(2 order).
  bool may_matter(std::size_t j, const Neighbour& neighbour, int order) const {
    return order * std::log(neighbour.image / placement_[j].scatterer.radius) <
           -2 * std::log(tolerance_);
  }

  int single_order(Species& own, double sensor) {
    for (int more = first_orders;; more *= 2)
      if (const auto order = order_within(own, single_strength(own, own.oscillating + more), sensor,
                                          single_safety)) {
        if (*order > rules_.highest)
          throw InputError("radius", own.scatterer.radius,
                           "requires basis order " + std::to_string(*order) + ", more than " +
                               std::to_string(rules_.highest) +
                               "; allow a larger tolerance, or a larger wavelength");
        return *order;
      }
  }

  int pair_order(std::size_t j, const Neighbour& neighbour, double sensor) {
    Species& own = species_[species_of_[j]];
    const Contact contact = contact_of(j, neighbour);
    const bool plasmons =
        contact.step < 0 &&
        (amplifies_images(own.scatterer) || amplifies_images(species_[contact.second].scatterer));
    met_gap_plasmons_ = met_gap_plasmons_ || plasmons;
    const bool space = rules_.kind == Radial::spherical;
    const int most = space ? 2 * rules_.highest : most_paired(own.scatterer, plasmons),
              highest = own.oscillating + 3 * most / 4;
    const double factor = safety(own.scatterer, k_, rules_.kind);
    for (int more = first_orders; more <= most; more *= 2) {
      const auto& strength = pair_strength(contact, own.oscillating + more);
      if (const auto order = order_within(own, strength, sensor, factor)) {
        if (*order > rules_.highest) refuse(j, *order, rules_.highest);
        return *order;
      }
      if (plasmons && least_order(contact, strength) > highest)
        refuse(j, least_order(contact, strength), highest);
    }
    if (plasmons || space)
      refuse(j, space ? rules_.highest + 1 : highest + 1, space ? rules_.highest : highest);
    return bounded_order(j, contact, sensor);
  }

  // The functions below return "strengths": for each order n, log2 of an upper bound of |beta_n|.
  const std::vector<double>& single_strength(Species& own, int size) {
    own.extend(size);
    single_.resize(size + 1);
    for (int n = 0; n <= size; ++n)
      single_[n] =
          (own.log_t[n] + (rules_.kind == Radial::spherical ? std::log2(2.0 * n + 1) : 0.0)) / 2;
    return single_;
  }

  const std::vector<double>& pair_strength(const Contact& contact, int size) {
    auto& strength = paired_[{contact, size}];
    if (!strength.empty()) return strength;
    Species &own = species_[contact.first], &other = species_[contact.second];
    const double distance = distance_of(contact), a = own.scatterer.radius,
                 b = other.scatterer.disk_radius();
    int other_size = 0;
    if (b > 0) {  // so that both disks resolve the same number of images
      const double ratio = xi(a, b, distance) / xi(b, a, distance);
      const auto more = static_cast<int>(ratio * (size - own.oscillating));
      other_size = other.oscillating + std::clamp(more, first_orders, rules_.highest);
    }
    strength = rules_.pair_response(own.up_to(size), other.up_to(other_size), k_, distance);
    for (double& s : strength) s = std::log2(s);
    return strength;
  }

  // Returns log2 of the bound (F |T_n|)^(1/2) w_n of beta_n (symbols: basis()), which assumes that
  // images are as strong as the field that causes them.
  const std::vector<double>& bound(const Contact& contact, int size) {
    auto& strength = bounds_[{contact, size}];
    if (!strength.empty()) return strength;
    Species &own = species_[contact.first], &other = species_[contact.second];
    const double distance = distance_of(contact), a = own.scatterer.radius,
                 b = other.scatterer.disk_radius();
    strength = log_hankel(size, k_, nearest_image(a, b, distance), rules_.kind);
    if (b > 0) {
      other.extend(size);
      auto sent = log_hankel(size, k_, nearest_image(b, a, distance), rules_.kind);
      for (int m = 0; m <= size; ++m) sent[m] = other.log_t[m] + std::max(0.0, sent[m]);
      const auto translation = log_hankel(2 * size, k_, distance, rules_.kind);
      for (int n = 0; n <= size; ++n)
        for (int m = 0; m <= size; ++m)
          strength[n] = std::max(strength[n], sent[m] + translation[n + m]);
    }
    own.extend(size);
    for (int n = 0; n <= size; ++n)
      strength[n] = std::max(0.0, strength[n]) + (own.log_t[n] + std::log2(own.field)) / 2;
    return strength;
  }

  // Returns the lowest order that is sufficient by the criterion of basis(); nullopt if the
  // strengths contain too few orders to determine it.
  std::optional<int> order_within(Species& own, const std::vector<double>& strength, double sensor,
                                  double safety_factor) const {
    if (strength.empty()) return std::nullopt;
    const int size = static_cast<int>(strength.size()) - 1;
    own.extend(size);
    if (own.field == 0) return 0;
    const auto receiver = log_hankel(size, k_, sensor, rules_.kind);
    const bool inside = own.scatterer.is_penetrable() && is_on_rim(own.scatterer, sensor);
    const auto rim = inside ? own.log_rim(size) : std::vector<double>(size + 1, -nowhere);
    const double most = tolerance_ * own.field;
    double rest = 0;
    int order = size + 1;
    while (order > 0 && rest <= most) {
      --order;
      const double near = strength[order] + own.log_t[order] / 2 + receiver[order];
      rest += safety_factor * std::exp2(2 * strength[order]) + near_safety * std::exp2(near) +
              near_safety * own.field * std::exp2(strength[order] + rim[order]);
    }
    if (order > own.oscillating + 3 * (size - own.oscillating) / 4) return std::nullopt;
    return order;
  }

  int bounded_order(std::size_t j, const Contact& contact, double sensor) {
    Species& own = species_[contact.first];
    const double statics = -std::log(tolerance_) / decay_of(contact);
    if (statics > rules_.highest) refuse(j, statics, rules_.highest);
    for (int size = 128 + own.oscillating + static_cast<int>(1.4 * statics);; size *= 2) {
      const auto order =
          order_within(own, bound(contact, size), sensor, bound_safety(own.scatterer, k_));
      if (order && *order > rules_.highest) refuse(j, *order, rules_.highest);
      if (order) return *order;
    }
  }

  // Returns the rate 2 xi at which repeated images of a charge decay with the order n, as e^{-2 xi
  // n}.
  double decay_of(const Contact& contact) const {
    return 2 * xi(species_[contact.first].scatterer.radius,
                  species_[contact.second].scatterer.disk_radius(), distance_of(contact));
  }

  // Estimates the required order, with the assumption that strengths beyond half of the known
  // orders decay like those of images.
  double least_order(const Contact& contact, const std::vector<double>& strength) const {
    const std::size_t half = strength.size() / 2;
    if (strength.empty()) return 0;
    const double most =
        *std::max_element(strength.begin() + static_cast<std::ptrdiff_t>(half),
                          strength.begin() + static_cast<std::ptrdiff_t>(half + half / 2));
    const double left = std::min(0.0, 2 * most - std::log2(species_[contact.first].field));
    return static_cast<double>(half) +
           (left * std::numbers::ln2 - std::log(tolerance_)) / decay_of(contact);
  }

  [[noreturn]] void refuse(std::size_t j, double order, int highest) const {
    const auto& [position, scatterer] = placement_[j];
    const bool space = rules_.kind == Radial::spherical;
    throw InputError(
        "radius", scatterer.radius,
        std::string(space ? "the sphere at (" : "the disk at (") + std::to_string(position.x) +
            ", " + (space ? std::to_string(position.y) + ", " : "") + std::to_string(position.z) +
            ") is so close to a neighbour that it requires basis order " +
            std::to_string(static_cast<long long>(std::ceil(std::min(order, 1e9)))) +
            ", more than " + std::to_string(highest) +
            (highest < rules_.highest ? " next to a TE disk with Re(index^2) < 0" : "") +
            "; widen the gap (min_gap) or allow a larger tolerance");
  }

  double k_, tolerance_;
  OrderRules rules_;
  Placement placement_;
  std::span<const Vec> sensors_;
  std::vector<std::size_t> species_of_;
  std::vector<Species> species_;
  // Results of pair_strength() and bound(), by contact and highest order.
  std::map<std::pair<Contact, int>, std::vector<double>> paired_, bounds_;
  std::vector<double> single_;
  bool met_gap_plasmons_ = false;
};

BasisOrders::BasisOrders(double k, double tolerance, const OrderRules& rules)
    : search_(std::make_unique<Search>(k, tolerance, rules)) {}

BasisOrders::~BasisOrders() = default;

Basis BasisOrders::basis(const Placement& placement, std::span<const Vec> sensors, double growth) {
  return search_->basis(placement, sensors, growth);
}

}  // namespace flatspeckle::wave
