// The thesis's tables 4.1 to 4.4 of voxelization matrices, as printed, and ours.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <vector>

#include "core/thesis/neighborhood.h"
#include "core/thesis/voxelization_matrix.h"
#include "tests/unit/core/exact.h"

namespace latvox {
namespace {

// A row of the thesis's tables: principal direction (world) and M, as printed, by rows.
struct TableRow {
  Vec3d direction;
  Mat3d m_rows;
};

Mat3d Transposed(const Mat3d& m) {
  Mat3d t;
  for (size_t r = 0; r < 3; ++r) {
    for (size_t c = 0; c < 3; ++c) t[c][r] = m[r][c];
  }
  return t;
}

const std::vector<TableRow> kTable41{{{1, 0, 0}, {{{0, 0, 1}, {0, -1, 0}, {1, 0, 0}}}},
                                     {{0, 1, 0}, {{{-1, 0, 0}, {0, 0, 1}, {0, 1, 0}}}},
                                     {{0, 0, 1}, {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}}};
const std::vector<TableRow> kTable42{
    {{1, 1, 0}, {{{0, 0, 1}, {0, 1, 1}, {-1, 0, 0}}}},  {{1, 0, 1}, {{{0, 0, 1}, {0, -1, 0}, {1, 0, 1}}}},
    {{0, 1, 1}, {{{1, 0, 0}, {0, 1, 1}, {0, 0, 1}}}},   {{-1, 1, 0}, {{{0, 0, -1}, {0, 1, 1}, {1, 0, 0}}}},
    {{-1, 0, 1}, {{{0, 0, -1}, {0, 1, 0}, {1, 0, 1}}}}, {{0, -1, 1}, {{{1, 0, 0}, {0, 1, -1}, {0, 0, 1}}}}};
const std::vector<TableRow> kTable43{{{1, 1, 1}, {{{0, 0, 1}, {0, 1, 1}, {-1, 0, 1}}}},
                                     {{-1, 1, 1}, {{{0, 0, -1}, {0, 1, 1}, {1, 0, 1}}}},
                                     {{1, -1, 1}, {{{1, 0, 1}, {0, 1, -1}, {0, 0, 1}}}},
                                     {{1, 1, -1}, {{{-1, 0, 1}, {0, 1, 1}, {0, 0, -1}}}}};
const std::vector<TableRow> kTable44{
    {{2, 0, 0}, {{{1, 0, 2}, {1, -2, 0}, {1, 0, 0}}}},  {{0, 2, 0}, {{{1, 2, 0}, {1, 0, 2}, {1, 0, 0}}}},
    {{0, 0, 2}, {{{1, -2, 0}, {1, 0, 0}, {1, 0, 2}}}},  {{1, 1, 1}, {{{2, 0, 1}, {0, 2, 1}, {0, 0, 1}}}},
    {{-1, 1, 1}, {{{2, 0, -1}, {0, 2, 1}, {0, 0, 1}}}}, {{1, -1, 1}, {{{2, 0, 1}, {0, 2, -1}, {0, 0, 1}}}},
    {{1, 1, -1}, {{{2, 0, 1}, {0, -2, 1}, {0, 0, -1}}}}};
// The column N of table 4.4 as printed, by rows.
const std::vector<Mat3d> kTable44N{{{{0.5, 0, 1.5}, {0.5, -1, 0.5}, {0.5, 0, -0.5}}},
                                   {{{0.5, 1, -1.5}, {0.5, 0, 1.5}, {0.5, 0, -0.5}}},
                                   {{{0.5, -1, 0.5}, {0.5, 0, -0.5}, {0.5, 0, 1.5}}},
                                   {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
                                   {{{1, 0, -2}, {0, 1, 0}, {0, 0, 1}}},
                                   {{{1, 0, 0}, {0, 1, -2}, {0, 0, 1}}},
                                   {{{1, 0, 0}, {0, -1, 2}, {0, 0, -1}}}};

Mat3d NOf(const Lattice& lattice, const Mat3d& m) {
  Mat3d n;
  for (size_t c = 0; c < 3; ++c) n[c] = Apply(lattice.inverse(), m[c]);
  return n;
}

struct Table {
  const char* name;
  Lattice lattice;
  int k;
  const std::vector<TableRow>& rows;
};

std::vector<Table> Tables() {
  const Lattice cartesian = ExactLattices()[0].lattice, bcc = ExactLattices()[1].lattice;
  return {{"4.1", cartesian, 2, kTable41},
          {"4.2", cartesian, 1, kTable42},
          {"4.3", cartesian, 0, kTable43},
          {"4.4", bcc, 2, kTable44}};
}

TEST(VoxelizationMatrix, EveryMatrixOfTheThesissTablesIsValid) {
  for (const Table& table : Tables()) {
    for (const TableRow& row : table.rows) {
      const Mat3d m = Transposed(row.m_rows);
      EXPECT_EQ(m[2], row.direction) << table.name;
      const Mat3d n = NOf(table.lattice, m);
      EXPECT_EQ(std::abs(Determinant(n)), 1) << table.name;
      for (const Vec3d& column : n) {
        for (double x : column) EXPECT_EQ(x, std::round(x)) << table.name;
      }
    }
  }
}

TEST(VoxelizationMatrix, OursIsValidForEveryDirectionOfTheTablesAndTheTablesLeaveNoneOut) {
  for (const Table& table : Tables()) {
    const auto& frames = table.lattice.frames(table.k);
    for (const TableRow& row : table.rows) {
      const auto same_line = [&](const Frame& frame) {
        const Vec3d q = Apply(table.lattice.basis(), frame.q);
        return q == row.direction || q == -row.direction;
      };
      const auto frame = std::find_if(frames.begin(), frames.end(), same_line);
      ASSERT_NE(frame, frames.end()) << table.name;
      const VoxelizationMatrix ours = MakeVoxelizationMatrix(table.lattice, *frame);
      EXPECT_EQ(std::abs(Determinant(ours.n)), 1);
      EXPECT_EQ(ours.n[2], frame->q);
      EXPECT_TRUE(ours.m[2] == row.direction || ours.m[2] == -row.direction);
      const Mat3d n = NOf(table.lattice, ours.m);
      for (size_t c = 0; c < 3; ++c) EXPECT_EQ(n[c], ToDouble(ours.n[c]));
    }
  }
  EXPECT_EQ(kTable41.size(), Tables()[0].lattice.frames(2).size());
  EXPECT_EQ(kTable41.size() + kTable42.size(), Tables()[1].lattice.frames(1).size());
  EXPECT_EQ(kTable41.size() + kTable42.size() + kTable43.size(), Tables()[2].lattice.frames(0).size());
  EXPECT_EQ(kTable44.size(), Tables()[3].lattice.frames(2).size());
}

// Erratum: the column N of table 4.4 is V^-1 M with eq. 4.3's V in the row (1,1,1) alone.
TEST(VoxelizationMatrix, ColumnNOfTable44IsWrongInEveryRowButOne) {
  const Lattice bcc = ExactLattices()[1].lattice;
  for (size_t row = 0; row < kTable44.size(); ++row) {
    const Mat3d computed = NOf(bcc, Transposed(kTable44[row].m_rows));
    const bool right = computed == Transposed(kTable44N[row]);
    EXPECT_EQ(right, kTable44[row].direction == (Vec3d{1, 1, 1})) << "row " << row;
  }
  EXPECT_EQ(NOf(bcc, Transposed(kTable44[4].m_rows))[2], (Vec3d{-1, 0, 1}));  // printed: (-2, 0, 1)
}

TEST(VoxelizationMatrix, DeterminantsOfTheTablesAreOneButForBccsCellVolume) {
  for (const Table& table : Tables()) {
    for (const TableRow& row : table.rows) {
      EXPECT_EQ(std::abs(Determinant(row.m_rows)), std::abs(Determinant(table.lattice.basis()))) << table.name;
    }
  }
  EXPECT_EQ(Determinant(kTable42[4].m_rows), 1);  // (-1,0,1), as the thesis states
}

}  // namespace
}  // namespace latvox
