#pragma once

#include <string>
#include <vector>

#include "flatland/scatterers/scatterer.h"

namespace flatspeckle {

/// S(q) of the positions in a medium (C16): a table over q in inverse lengths, linear between its
/// nodes, constant below the first, 1 above the last. Without nodes: independent positions, S = 1.
class StructureTable {
 public:
  StructureTable() = default;
  /// q rises; no value is negative. origin: in words, for plans.
  StructureTable(std::string origin, std::vector<double> q, std::vector<double> values);

  bool independent() const { return q_.empty(); }
  const std::string& origin() const { return origin_; }
  double operator()(double q) const;
  /// Every node, exactly: tells one table from another.
  std::string text() const;

 private:
  std::string origin_;
  std::vector<double> q_, values_;
};

/// Number per area and least distance between the centres of equal disks.
struct DiskSpacing {
  double density = 0, contact = 0;

  /// Counts the contact diameters, so with half the gap around each disk.
  double packing() const;
};

/// The equilibrium fluid of hard disks (HardDiskFluid), for momentum transfers up to q_max. Throws
/// InputError above packing 0.7.
StructureTable hard_disk_structure(const DiskSpacing& disks, double q_max);

/// structure_factor over q of a file that `place --structure` wrote. Throws InputError where it was
/// measured on disks of another density or contact distance (differences up to 2 % pass: numbers
/// of disks are whole), or where a value is not positive.
StructureTable read_structure(const std::string& path, const DiskSpacing& disks);

}  // namespace flatspeckle
