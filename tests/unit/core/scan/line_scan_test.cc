// The scan of a triangle's lines in integers that are linear over them gives the same result in fewer bits as in 64.
#include "core/scan/line_scan.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <vector>

#include "core/digitize/crossing.h"
#include "tests/unit/core/exact.h"
#include "tests/unit/core/triangles.h"

namespace latvox {
namespace {

// The expected values of one line.
struct LineFacts {
  bool candidate, inside, in_doubt;
  int64_t depth;
  bool above;
};

template <class T>
LineFacts FactsOf(const LineScan<T>& lines, int32_t a, int32_t b) {
  LineFacts facts{true, true, false, 0, false};
  for (size_t n = 0; n < 3; ++n) {
    const auto edge =
        static_cast<T>(int64_t{lines.edge[n]} + int64_t{lines.edge_a[n]} * a + int64_t{lines.edge_b[n]} * b);
    facts.candidate &= static_cast<T>(int64_t{edge} + lines.rim[n]) >= 0;  // as lanes add
    facts.inside &= edge >= 0;
  }
  const auto level = crossing_internal::FloorDivision(
      __int128{lines.remainder} + __int128{lines.level_a} * a + __int128{lines.level_b} * b, lines.along);
  facts.depth = lines.depth + level.quotient;
  facts.above = level.remainder >= lines.half;
  for (const int64_t tie : {int64_t{0}, int64_t{lines.half}, int64_t{lines.along}}) {
    facts.in_doubt |= std::abs(level.remainder - tie) <= lines.doubt && lines.doubt != 0;
  }
  return facts;
}

TEST(LineScan, IsTheSameInFewerBitsWhereItIsNotInDoubt) {
  const Vec3i tile_min{0, 0, 0};
  for (const ExactLattice& l : ExactLattices()) {
    const auto frames = MakeScanFrames(l.lattice.frames(0));
    const IndexBox box{tile_min, tile_min + Vec3i{kTileSide, kTileSide, kTileSide} * 2};
    std::vector<Triangle> triangles = LargeAndClose(tile_min);
    const size_t close = triangles.size();
    for (const int32_t size : {20000, 1 << 19, 1 << 23}) {
      const auto some = TrianglesAround(tile_min, size, 60);
      triangles.insert(triangles.end(), some.begin(), some.end());
    }
    size_t rounded_lines = 0, in_doubt = 0, exact = 0;
    for (size_t t = 0; t < triangles.size(); ++t) {
      const OrientedTriangle triangle(triangles[t]);
      if (triangle.normal == Vec<int64_t, 3>{}) continue;
      const ScanFrame& scan = PrincipalScanFrame(frames, triangle.normal);
      LineScan<int64_t> lines;
      if (!MakeLineScan(triangle, scan, box, NearBox(frames, box), lines)) continue;
      for (const bool rounded : {true, false}) {
        LineScan<int32_t> narrow;
        if (!Narrow(lines, rounded, narrow)) continue;
        EXPECT_EQ(narrow.doubt != 0, rounded);
        if (!rounded) ++exact;
        for (int32_t b = 0; b < lines.height; ++b) {
          for (int32_t a = 0; a < lines.width; ++a) {
            const LineFacts want = FactsOf(lines, a, b), got = FactsOf(narrow, a, b);
            ASSERT_EQ(got.candidate, want.candidate) << l.name << " triangle " << t << " line " << a << " " << b;
            if (!want.candidate) continue;
            ASSERT_EQ(got.inside, want.inside) << l.name << " triangle " << t << " line " << a << " " << b;
            if (rounded) {  // tests the size of the error, even where it has no effect
              const auto truth = __int128{lines.remainder} + __int128{lines.level_a} * a + __int128{lines.level_b} * b;
              const auto scaled =
                  __int128{narrow.remainder} + __int128{narrow.level_a} * a + __int128{narrow.level_b} * b;
              const __int128 wrong = scaled * lines.along - (truth << kScaledBits);
              ASSERT_LT(static_cast<double>(wrong < 0 ? -wrong : wrong) / static_cast<double>(lines.along),
                        narrow.doubt)
                  << l.name << " triangle " << t << " line " << a << " " << b;
            }
            if (rounded && t >= close) {
              ++rounded_lines;
              in_doubt += got.in_doubt ? 1 : 0;
            }
            if (got.in_doubt) continue;
            ASSERT_EQ(got.depth, want.depth) << l.name << " triangle " << t << " line " << a << " " << b;
            ASSERT_EQ(got.above, want.above) << l.name << " triangle " << t << " line " << a << " " << b;
          }
        }
      }
    }
    EXPECT_GT(exact, 10U) << l.name;
    EXPECT_GT(rounded_lines, 10000U) << l.name;
    EXPECT_LT(in_doubt, rounded_lines / 1000) << l.name;
  }
}

}  // namespace
}  // namespace latvox
