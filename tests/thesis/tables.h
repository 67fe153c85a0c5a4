// The thesis's tables 4.1 to 4.4: its voxelization matrices, checked, beside ours.
#ifndef LATVOX_TESTS_THESIS_TABLES_H_
#define LATVOX_TESTS_THESIS_TABLES_H_

#include <string>
#include <vector>

#include "core/base/vec.h"

namespace latvox::thesis {

// A row as printed, and the checked facts about it. Matrices are by columns.
struct TableRow {
  std::string table;  // "4.1"
  Vec3i direction;    // principal, world units
  Mat3d m, n;         // as printed

  double det_n = 0;        // of V^-1 M for the printed M
  Mat3d true_n{};          // V^-1 M
  bool spans = false;      // V^-1 M is integer with determinant 1 or -1: M spans the lattice
  bool is_last = false;    // M's last column is the direction
  bool n_right = false;    // the printed N is V^-1 M
  Mat3d our_m{}, our_n{};  // MakeVoxelizationMatrix
  double our_det_n = 0;
};

std::vector<TableRow> CheckedTables();

// Returns the matrix by rows: "1 0 0 / 0 1 0 / 0 0 1".
std::string TextOf(const Mat3d& matrix);

}  // namespace latvox::thesis

#endif  // LATVOX_TESTS_THESIS_TABLES_H_
