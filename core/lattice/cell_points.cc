#include "core/lattice/cell_points.h"

#include <algorithm>

namespace latvox {
namespace {

using Vec3l = Vec<int64_t, 3>;

// A step from a cell to the one across a facet.
struct Step {
  Vec3i w;
  Vec3l dual;      // G w
  int64_t square;  // n w.G w
  bool wins_ties;  // the shift moves the border towards the cell that the step leaves
};

std::vector<Step> StepsOf(const IntegerCell& cell, int32_t n) {
  std::vector<Step> steps;
  for (const Vec3i& facet : cell.facets()) {
    for (const Vec3i& w : {facet, -facet}) {
      const Vec3l dual = Apply(cell.form(), w);
      steps.push_back({w, dual, n * Dot(dual, w), FirstNonzeroIsPositive(-dual)});
    }
  }
  return steps;
}

// Moves a point into the cell of 0. It lies nearer to w than to 0 iff n w.G w < 2 point.G w. Entries of G have 39 bits,
// of w 4 and of points 15, so 64 bits are enough. Each step comes nearer, so no cell comes twice.
Vec3i ToCellOfZero(Vec3i point, const std::vector<Step>& steps, int32_t n) {
  const auto next = [&] {
    return std::ranges::find_if(steps, [&](const Step& step) {
      const int64_t beyond = 2 * Dot(step.dual, point) - step.square;
      return beyond > 0 || (beyond == 0 && step.wins_ties);
    });
  };
  for (auto step = next(); step != steps.end(); step = next()) point = point - step->w * n;
  return point;
}

}  // namespace

CellPoints PointsOf(const IntegerCell& cell, int32_t n) {
  const std::vector<Step> steps = StepsOf(cell, n);
  std::vector<Vec3i> points;
  for (int32_t i = 0; i < n; ++i) {
    for (int32_t j = 0; j < n; ++j) {
      for (int32_t k = 0; k < n; ++k) points.push_back(ToCellOfZero({i, j, k}, steps, n));
    }
  }
  std::ranges::sort(points);
  CellPoints cell_points{n, {}, {}, {}};
  for (const Vec3i& point : points) {
    for (size_t m = 0; m < 3; ++m) {
      cell_points.low[m] = std::min(cell_points.low[m], point[m]);
      cell_points.high[m] = std::max(cell_points.high[m], point[m]);
    }
    const bool follows = !cell_points.runs.empty() &&
                         cell_points.runs.back().first + Vec3i{0, 0, cell_points.runs.back().count} == point;
    if (follows) {
      ++cell_points.runs.back().count;
    } else {
      cell_points.runs.push_back({point, 1});
    }
  }
  return cell_points;
}

}  // namespace latvox
