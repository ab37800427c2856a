#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace flatspeckle {

// Units of numbers that users write, such as nm, 1/mm, deg, us, GHz, m^2/s or mPa s.

/// Exponents of the base quantities in a unit.
struct Dimension {
  int length = 0, time = 0, mass = 0, temperature = 0, angle = 0;

  bool operator==(const Dimension&) const = default;
};

/// A unit: its dimension and its size in m, s, kg, K and rad.
struct Unit {
  Dimension dimension = {};
  double size = 1;
};

/// Parses a unit: names from a table with exponents, multiplied (by a blank or *) and divided, such
/// as "um", "/mm", "1/Pa", "m^2/s" or "mPa s". A slash applies to the next name only. Returns
/// nullopt for any other text.
std::optional<Unit> unit_of(std::string_view text);

/// Unit of the numbers of a key. Numbers with a unit of the same dimension are converted to it.
class KeyUnit {
 public:
  /// text: as in Key::unit(). "length" is the scene's unit of length, in which most keys are given:
  /// "length", "1/length^2"; " or " separates alternatives: "1/length or length". Keys with any
  /// other text, which is not a unit, take plain numbers. metres: the scene's unit of length in
  /// metres, if it is known.
  explicit KeyUnit(std::string text = "", const std::optional<double>& metres = {});

  /// Whether a number may be written in this unit.
  bool accepts(const Unit& unit) const;
  /// Whether conversion from this unit requires the scene's unit of length, and it is not known.
  bool lacks_length(const Unit& unit) const;
  /// Returns a number that is written in this unit in the unit of the key. Powers of ten are
  /// converted without rounding errors in the first 15 digits.
  double convert(double number, const Unit& unit) const;
  /// Returns the requirement, e.g. "must be a number such as 0.1 or 0.5 mm".
  std::string accepted() const;

 private:
  struct Alternative {
    Unit unit;
    bool is_of_scene;  ///< whether it is given by the scene's unit of length
  };
  const Alternative* find(const Unit& unit) const;

  std::string text_;
  std::optional<double> metres_;
  std::vector<Alternative> alternatives_;
};

}  // namespace flatspeckle
