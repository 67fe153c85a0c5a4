#include "tests/thesis/tables.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_format.h"
#include "core/thesis/voxelization_matrix.h"
#include "tests/thesis/experiment.h"

namespace latvox::thesis {
namespace {

// As printed, by rows. On the Cartesian lattice N is M.
struct PrintedRow {
  const char* table;
  Vec3i direction;
  Mat3d m_rows, n_rows;
};

PrintedRow Cartesian(const char* table, const Vec3i& direction, const Mat3d& m_rows) {
  return {table, direction, m_rows, m_rows};
}

std::vector<PrintedRow> PrintedRows() {
  return {Cartesian("4.1", {1, 0, 0}, {{{0, 0, 1}, {0, -1, 0}, {1, 0, 0}}}),
          Cartesian("4.1", {0, 1, 0}, {{{-1, 0, 0}, {0, 0, 1}, {0, 1, 0}}}),
          Cartesian("4.1", {0, 0, 1}, {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}),
          Cartesian("4.2", {1, 1, 0}, {{{0, 0, 1}, {0, 1, 1}, {-1, 0, 0}}}),
          Cartesian("4.2", {1, 0, 1}, {{{0, 0, 1}, {0, -1, 0}, {1, 0, 1}}}),
          Cartesian("4.2", {0, 1, 1}, {{{1, 0, 0}, {0, 1, 1}, {0, 0, 1}}}),
          Cartesian("4.2", {-1, 1, 0}, {{{0, 0, -1}, {0, 1, 1}, {1, 0, 0}}}),
          Cartesian("4.2", {-1, 0, 1}, {{{0, 0, -1}, {0, 1, 0}, {1, 0, 1}}}),
          Cartesian("4.2", {0, -1, 1}, {{{1, 0, 0}, {0, 1, -1}, {0, 0, 1}}}),
          Cartesian("4.3", {1, 1, 1}, {{{0, 0, 1}, {0, 1, 1}, {-1, 0, 1}}}),
          Cartesian("4.3", {-1, 1, 1}, {{{0, 0, -1}, {0, 1, 1}, {1, 0, 1}}}),
          Cartesian("4.3", {1, -1, 1}, {{{1, 0, 1}, {0, 1, -1}, {0, 0, 1}}}),
          Cartesian("4.3", {1, 1, -1}, {{{-1, 0, 1}, {0, 1, 1}, {0, 0, -1}}}),
          {"4.4", {2, 0, 0}, {{{1, 0, 2}, {1, -2, 0}, {1, 0, 0}}}, {{{0.5, 0, 1.5}, {0.5, -1, 0.5}, {0.5, 0, -0.5}}}},
          {"4.4", {0, 2, 0}, {{{1, 2, 0}, {1, 0, 2}, {1, 0, 0}}}, {{{0.5, 1, -1.5}, {0.5, 0, 1.5}, {0.5, 0, -0.5}}}},
          {"4.4", {0, 0, 2}, {{{1, -2, 0}, {1, 0, 0}, {1, 0, 2}}}, {{{0.5, -1, 0.5}, {0.5, 0, -0.5}, {0.5, 0, 1.5}}}},
          {"4.4", {1, 1, 1}, {{{2, 0, 1}, {0, 2, 1}, {0, 0, 1}}}, {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}},
          {"4.4", {-1, 1, 1}, {{{2, 0, -1}, {0, 2, 1}, {0, 0, 1}}}, {{{1, 0, -2}, {0, 1, 0}, {0, 0, 1}}}},
          {"4.4", {1, -1, 1}, {{{2, 0, 1}, {0, 2, -1}, {0, 0, 1}}}, {{{1, 0, 0}, {0, 1, -2}, {0, 0, 1}}}},
          {"4.4", {1, 1, -1}, {{{2, 0, 1}, {0, -2, 1}, {0, 0, -1}}}, {{{1, 0, 0}, {0, -1, 2}, {0, 0, -1}}}}};
}

Mat3d Transposed(const Mat3d& m) {
  Mat3d out;
  for (size_t c = 0; c < 3; ++c) {
    for (size_t r = 0; r < 3; ++r) out[r][c] = m[c][r];
  }
  return out;
}

bool IsInteger(const Mat3d& m) {
  return std::all_of(m.begin(), m.end(), [](const Vec3d& column) {
    return std::all_of(column.begin(), column.end(), [](double x) { return x == std::round(x); });
  });
}

TableRow Checked(const PrintedRow& printed, const Lattice& lattice) {
  TableRow row{printed.table, printed.direction, Transposed(printed.m_rows), Transposed(printed.n_rows)};
  // V's entries are small powers of two, so all of this is exact.
  for (size_t c = 0; c < 3; ++c) row.true_n[c] = Apply(lattice.inverse(), row.m[c]);
  row.det_n = Determinant(row.true_n);
  row.spans = IsInteger(row.true_n) && std::abs(row.det_n) == 1;
  row.is_last = row.m[2] == Apply(Mat3d{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, printed.direction);
  row.n_right = row.n == row.true_n;

  const Vec3d q = Apply(lattice.inverse(), printed.direction);
  const auto frame = MakeFrame({static_cast<int32_t>(q[0]), static_cast<int32_t>(q[1]), static_cast<int32_t>(q[2])});
  const VoxelizationMatrix ours = MakeVoxelizationMatrix(lattice, frame.value());
  row.our_m = ours.m;
  for (size_t c = 0; c < 3; ++c) {
    for (size_t r = 0; r < 3; ++r) row.our_n[c][r] = ours.n[c][r];
  }
  row.our_det_n = Determinant(row.our_n);
  return row;
}

}  // namespace

std::vector<TableRow> CheckedTables() {
  const std::vector<LatticeCase> cases = LatticeCases();
  std::vector<TableRow> rows;
  for (const PrintedRow& printed : PrintedRows()) {
    const bool bcc = std::string_view(printed.table) == "4.4";
    rows.push_back(Checked(printed, cases[bcc ? 3 : 0].lattice));
  }
  return rows;
}

std::string TextOf(const Mat3d& matrix) {
  std::string text;
  for (size_t r = 0; r < 3; ++r) {
    absl::StrAppendFormat(&text, "%s%g %g %g", r == 0 ? "" : " / ", matrix[0][r] + 0.0, matrix[1][r] + 0.0,
                          matrix[2][r] + 0.0);
  }
  return text;
}

}  // namespace latvox::thesis
