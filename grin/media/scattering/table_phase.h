#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/keys/angle_table.h"
#include "core/numbers/complex.h"
#include "grin/media/scattering/space_phase.h"

namespace flatspeckle::grin {

/// A phase function that was measured or computed elsewhere. A CSV file contains it in the columns
/// angle (radians, rising from 0 to pi) and value (per solid angle; not negative, in any unit). The
/// phase function is linear between the rows of the table.
class TablePhase {
 public:
  explicit TablePhase(AngleTable table);

  double density(double cosine) const;
  double one_minus_cosine(RandomStream& random) const;
  double mean_cosine() const { return shape_->mean_cosine; }

 private:
  struct Shape {
    AngleTable table;
    /// Integral of the table over the sphere, from angle 0 to each angle of the table.
    std::vector<double> so_far = {0};
    double mean_cosine = 0;
  };
  std::shared_ptr<const Shape> shape_;
};

/// Returns the phase function proportional to the squared modulus of amplitudes at equal steps of
/// the scattering angle from 0 to pi.
TablePhase phase_of_amplitudes(const std::vector<Complex>& amplitudes);

struct TablePhaseValues {
  static constexpr const char* word = "phase_table";
  std::string phase_table{};
};

inline void add_keys(Keys& keys, TablePhaseValues& values, const std::string& prefix) {
  keys.add(prefix + "phase_table", values.phase_table,
           "CSV with columns angle (0 to pi) and value (any unit), linear between the rows")
      .file()
      .only_of(values.word);
}
/// Reads the phase function from the file given by its key. Throws InputError if the file does not
/// contain such a table.
TablePhase make_phase(const Keys& keys, const TablePhaseValues& values);

}  // namespace flatspeckle::grin
