// The distance from a lattice point to a triangle: its square in doubles, almost without error, exact comparisons with
// a limit and with other triangles, and the nearest point.
#ifndef LATVOX_CORE_BAND_TRIANGLE_DISTANCE_H_
#define LATVOX_CORE_BAND_TRIANGLE_DISTANCE_H_

#include <array>
#include <cstdint>

#include "core/band/metric.h"
#include "core/base/vec.h"
#include "core/digitize/crossing.h"

namespace latvox {

// A part of a triangle. Edge n leads from corner n to the next, and does not include its ends; the face does not
// include the edges.
struct TriangleFeature {
  enum Kind : uint8_t { kCorner, kEdge, kFace };
  Kind kind;
  uint8_t number;  // of the corner or the edge; 0 for the face
  bool operator==(const TriangleFeature&) const = default;
};

// A triangle of any shape, also without area. Points and corners are in units of 1/kLatticeUnit voxel, and no two of
// them are farther apart than kPointBits allow.
class TriangleDistance {
 public:
  // The metric must outlive it.
  TriangleDistance(const Metric& metric, const Triangle& triangle);

  // Returns the square of the distance from `point`, in units. It is a function of both alone, with a relative error
  // below kSquareError. It is 0 for a point of the triangle, and for no other.
  double SquareTo(const Vec3i& point) const;

  // Returns whether the square of the distance from `point` is at most `limit`, a square as of Inner.
  bool IsWithin(const Vec3i& point, __int128 limit) const;

  // Returns which of two triangles of one metric is nearer to `point`, exactly: below 0 for a, 0 for a tie, above 0 for
  // b.
  static int Compare(const TriangleDistance& a, const TriangleDistance& b, const Vec3i& point);

  // Returns the feature that holds the nearest point of the triangle, exactly. A triangle without area has no face.
  TriangleFeature FeatureNear(const Vec3i& point) const;

  // Returns the weights of the second and the third corner in the nearest point of the triangle, with an error below
  // 2^-50 of each. `feature`: that of FeatureNear.
  std::array<double, 2> WeightsNear(const Vec3i& point, TriangleFeature feature) const;

  const Triangle& corners() const { return corners_; }
  // (second - first) x (third - first), in lattice coordinates: exact, a covector; 0 iff there is no area.
  const Vec<int64_t, 3>& normal() const { return normal_; }
  bool has_area() const { return normal_ != Vec<int64_t, 3>{}; }

  const Vec3i& corner() const { return corners_[0]; }
  // The center of a circle in the triangle's plane that contains the triangle, in the metric's Cartesian coordinates
  // relative to corner(); units.
  const Vec3d& center() const { return center_; }
  double radius() const { return radius_; }
  // The plane's normal of length 1; 0 for a triangle without area.
  const Vec3d& unit_normal() const { return unit_normal_; }

 private:
  struct Fraction;
  struct Projection;
  bool ProjectsInside(const std::array<Vec3i, 3>& d, const std::array<Vec3d, 3>& turns) const;
  bool ProjectsInside(const std::array<Vec3i, 3>& d) const;
  Projection Project(const Vec3i& d) const;
  Fraction ExactSquareTo(const Vec3i& point) const;
  TriangleFeature FeatureOfLine(const Vec3i& point) const;
  int SignOfTurn(size_t edge, const Vec3i& d) const;
  int SignAlong(size_t edge, const Vec3i& d) const;
  bool TurnsInward(size_t edge, const Vec3i& d) const;
  bool EdgeIsWithin(size_t edge, const Vec3i& d, __int128 limit) const;
  bool FaceIsWithin(const std::array<Vec3i, 3>& d, __int128 limit) const;

  const Metric& metric_;
  Triangle corners_;
  std::array<Vec3i, 3> edges_;        // from each corner to the next
  std::array<Vec3d, 3> edges_world_;  // root * edge
  std::array<double, 3> edge_squares_;
  Vec<int64_t, 3> normal_;  // edges_[0] x (corners_[2] - corners_[0])
  Vec3d normal_world_;      // cofactor * normal
  double normal_square_;
  Vec3d center_, unit_normal_;
  double radius_;
};

// Three roundings of vectors' squares and one quotient of them: see MakeMetric.
inline constexpr double kSquareError = 0x1p-33;

}  // namespace latvox

#endif  // LATVOX_CORE_BAND_TRIANGLE_DISTANCE_H_
