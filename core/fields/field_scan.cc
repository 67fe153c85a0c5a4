#include "core/fields/field_scan.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>
#include <utility>

namespace latvox {
namespace {

// Squares with a larger relative difference certainly belong to different distances.
constexpr double kDoubt = 4 * kSquareError;

// Triangles between two looks at the stop signal.
constexpr size_t kVisits = 4096;

// Returns whether a triangle may come within sqrt(square) of x, which is relative to its center: see BandScan::Rows.
bool MayComeWithin(const TriangleDistance& triangle, const Vec3d& x, double square) {
  const double radius_square = triangle.radius() * triangle.radius();
  square += 0x1p-29 * (radius_square + square);  // far more than rounding errors
  const double height = Dot(x, triangle.unit_normal()), q = square - height * height;
  if (q < 0) return false;
  const double beyond = Dot(x, x) - radius_square - square;
  return !(beyond > 0 && beyond * beyond > 4 * radius_square * q);
}

// Returns whether the nearest points are certainly the same, or the triangles are.
bool ShareNearestPoint(const Triangle& a, TriangleFeature of_a, const Triangle& b, TriangleFeature of_b) {
  if (of_a.kind != of_b.kind) return false;
  if (of_a.kind == TriangleFeature::kFace) return std::is_permutation(a.begin(), a.end(), b.begin());
  const Vec3i &first_a = a[of_a.number], &first_b = b[of_b.number];
  if (of_a.kind == TriangleFeature::kCorner) return first_a == first_b;
  const Vec3i &last_a = a[(of_a.number + 1) % 3], &last_b = b[(of_b.number + 1) % 3];
  return (first_a == first_b && last_a == last_b) || (first_a == last_b && last_a == first_b);
}

}  // namespace

void FieldScan::Find(const FieldContext& context, std::span<const uint32_t> triangles, const Interior* interior,
                     TileBricks& tile) {
  tile_min_ = tile.tile_ijk * kTileSide - context.mesh.base_ijk;
  has_inside_ = context.plan.is_signed;
  if (has_inside_) interior->Find(Shifted(tile_min_, kTileBits), triangles, inside_);
  if (context.plan.near_reach) bricks_.Begin(context.mesh, context.plan, triangles, tile_min_, context.stop);
  winner_.reset();
  shapes_.Begin();
  tile.fields.resize(context.plan.fields.size());
  for (const PlacedWriter& placed : context.writers) {
    tile.fields[placed.place].clear();
    tile.fields[placed.place].reserve(tile.voxels * FactsOf(context.plan.fields.view()[placed.place]).bytes(0, 0));
  }
  const double* square = context.plan.has_squares ? tile.squares.data() : nullptr;
  for (const Brick& brick : tile.bricks) {
    if (context.stop.Stopped()) return;
    if (context.plan.near_reach) {
      FindNearBrick(context, brick, tile);
    } else {
      FindBrick(context, brick, square, tile);
    }
  }
  tile.squares = {};
  tile.labels = {};
}

// Appends the labels of a brick. A voxel without a label gets `elsewhere`. Without that, returns false, and appends
// nothing.
bool FieldScan::AppendLabels(const Brick& brick, const TileBricks& tile, std::optional<uint32_t> elsewhere,
                             std::vector<std::byte>& out) {
  constexpr size_t kVoxels = size_t{kBrickSide} * kBrickSide * kBrickSide;
  std::array<uint32_t, kVoxels + kBrickSide> labels;  // a row's labels are written as a whole row
  uint32_t* next = labels.data();
  const Vec3i corner = (brick.brick_ijk - tile.tile_ijk * kBrickSide) * kBrickSide;  // in the tile
  const auto first_k = static_cast<uint32_t>(corner[2]);
  for (int32_t n = 0; n < kBrickSide * kBrickSide; ++n) {
    const int32_t x = n >> kBrickBits, y = n & (kBrickSide - 1);
    uint64_t bits = brick.mask[static_cast<size_t>(x)] >> (y << kBrickBits) & 0xFF;
    if (bits == 0) continue;
    const auto row = static_cast<size_t>((corner[0] + x) << kTileBits | (corner[1] + y));
    const LabelRun* run = tile.labels.Find(row, first_k);
    uint32_t end = tile.labels.EndOf(row, run);
    if (end >= first_k + kBrickSide && (run->label != kNoLabel || elsewhere)) {
      std::fill_n(next, kBrickSide, run->label != kNoLabel ? run->label : *elsewhere);
      next += std::popcount(bits);
      continue;
    }
    for (; bits != 0; bits &= bits - 1) {
      const uint32_t k = first_k + static_cast<uint32_t>(std::countr_zero(bits));
      while (k >= end) end = tile.labels.EndOf(row, ++run);
      if (run->label == kNoLabel && !elsewhere) return false;
      *next++ = run->label != kNoLabel ? run->label : *elsewhere;
    }
  }
  const std::span<const std::byte> bytes = std::as_bytes(std::span(labels.data(), next));
  out.insert(out.end(), bytes.begin(), bytes.end());
  return true;
}

// Appends the fields of a brick whose voxels all have the same numbers.
void FieldScan::AppendCopies(const FieldContext& context, const Brick& brick, std::span<const uint32_t> numbers,
                             TileBricks& tile) {
  Nearest nearest{};
  std::ranges::copy(numbers, nearest.numbers.begin());
  std::vector<std::byte> one;
  for (const auto& [place, writer] : context.writers) {
    one.clear();
    writer->Append(nearest, one);
    for (uint64_t n = CountVoxels(brick.mask); n > 0; --n) {
      tile.fields[place].insert(tile.fields[place].end(), one.begin(), one.end());
    }
  }
}

// For plan.near_reach.
void FieldScan::FindNearBrick(const FieldContext& context, const Brick& brick, TileBricks& tile) {
  const bool is_labeled = context.plan.label_place.has_value();
  const Vec3i in_tile = brick.brick_ijk - tile.tile_ijk * kBrickSide, corner = tile_min_ + in_tile * kBrickSide;
  const std::span<const uint32_t> agreed = bricks_.Agreed(in_tile);
  assert(!is_labeled || context.plan.is_label_alone);  // with other fields, points inside may be far from the mesh
  if (is_labeled) {
    const std::optional<uint32_t> elsewhere = agreed.empty() ? std::nullopt : std::optional(agreed.front());
    if (AppendLabels(brick, tile, elsewhere, tile.fields[context.writers.front().place])) return;
  } else if (!agreed.empty()) {
    return AppendCopies(context, brick, agreed, tile);
  }
  voxels_.Begin(context.mesh, context.plan, bricks_.TrianglesNear(in_tile), corner, context.stop);
  for (int32_t x = 0; x < kBrickSide; ++x) {
    for (uint64_t bits = brick.mask[static_cast<size_t>(x)]; bits != 0; bits &= bits - 1) {
      const int yz = std::countr_zero(bits);
      const Vec3i in_brick{x, yz >> kBrickBits, yz & (kBrickSide - 1)}, at = in_tile * kBrickSide + in_brick;
      Nearest nearest{(corner + in_brick) * kLatticeUnit, false, 0, 0, nullptr, {}};
      uint32_t label = kNoLabel;
      if (is_labeled) {
        const auto row = static_cast<size_t>(at[0] << kTileBits | at[1]);
        label = tile.labels.Find(row, static_cast<uint32_t>(at[2]))->label;
      }
      if (label != kNoLabel) {
        nearest.numbers.front() = label;
      } else if (!FindNumbers(context, in_brick, nearest)) {
        return;
      }
      for (const auto& [place, writer] : context.writers) writer->Append(nearest, tile.fields[place]);
    }
  }
}

// Finds nearest.numbers of a voxel of the brick. Returns false if the job was stopped before.
bool FieldScan::FindNumbers(const FieldContext& context, const Vec3i& voxel, Nearest& nearest) {
  if (const std::span<const uint32_t> agreed = voxels_.Agreed(voxel); !agreed.empty()) {
    std::ranges::copy(agreed, nearest.numbers.begin());
    return true;
  }
  candidates_.clear();
  least_ = context.plan.most_square;
  double limit = least_ * (1 + kDoubt);
  const std::span<const uint32_t> triangles = voxels_.TrianglesNear(voxel);
  for (size_t n = 0; n < triangles.size(); ++n) {
    if (n % kVisits == 0 && context.stop.Stopped()) return false;
    Offer(context, triangles[n], nearest.point, limit);
  }
  if (context.stop.Stopped()) return false;
  std::erase_if(candidates_, [limit](const Candidate& candidate) { return candidate.square > limit; });
  return Decide(context, nearest);
}

// `square`: null, or those of the brick's voxels; moves on to those of the next brick.
void FieldScan::FindBrick(const FieldContext& context, const Brick& brick, const double*& square, TileBricks& tile) {
  const bool is_labeled = context.plan.label_place.has_value();
  if (context.plan.is_label_alone &&
      AppendLabels(brick, tile, std::nullopt, tile.fields[context.writers.front().place])) {
    return;
  }
  const Vec3i corner = brick.brick_ijk * kBrickSide - context.mesh.base_ijk;
  if (context.plan.is_searched) List(context, corner);
  for (int32_t x = 0; x < kBrickSide; ++x) {
    for (uint64_t bits = brick.mask[static_cast<size_t>(x)]; bits != 0; bits &= bits - 1) {
      const int yz = std::countr_zero(bits);
      const Vec3i ijk = corner + Vec3i{x, yz >> kBrickBits, yz & (kBrickSide - 1)}, at = ijk - tile_min_;
      Nearest nearest{ijk * kLatticeUnit, false, 0, 0, nullptr, {}};
      const auto row = static_cast<size_t>(at[0] << kTileBits | at[1]);
      if (has_inside_) nearest.is_inside = (inside_.view()[row] >> at[2] & 1) != 0;
      const uint32_t label = is_labeled ? tile.labels.Find(row, static_cast<uint32_t>(at[2]))->label : kNoLabel;
      if (square != nullptr) nearest.square = *square++;
      const bool is_known = context.plan.is_label_alone && label != kNoLabel;
      if (context.plan.is_searched && !is_known && !RepeatsNumbers(context, nearest)) {
        FindCandidates(context, nearest.point, square != nullptr ? nearest.square : context.plan.most_square);
        if (context.stop.Stopped()) return;
        nearest.square = least_;
        if (!Decide(context, nearest)) return;
        numbers_ = nearest.numbers;
        is_new_winner_ = true;
      }
      if (label != kNoLabel) nearest.numbers[*context.plan.label_place] = label;
      for (const auto& [place, writer] : context.writers) writer->Append(nearest, tile.fields[place]);
    }
  }
}

// Returns whether nearest.numbers are certainly those that the search found last, and sets them. Far from the mesh,
// thousands of triangles may be nearly the nearest, but mostly they have the same numbers. The last winner bounds the
// distance. Where its bound is too loose, a search finds another one. Where even a new winner does not help, other
// numbers are near, and the next voxels are searched at once.
bool FieldScan::RepeatsNumbers(const FieldContext& context, Nearest& nearest) {
  constexpr int kPause = 16;
  if (!context.plan.are_numbers || !winner_) return false;
  if (pause_ > 0) {
    --pause_;
    return false;
  }
  const double bound = winner_->SquareTo(nearest.point) * (1 + kDoubt);
  const Vec3d x = Apply(context.plan.metric.root, ToDouble(nearest.point));
  if (context.index->MayFindOther(x, bound, numbers_.data())) {
    if (is_new_winner_) pause_ = kPause;
    return false;
  }
  is_new_winner_ = false;
  nearest.numbers = numbers_;
  return true;
}

// Lists the triangles that come as near to the box around a brick as those of its voxels can be. Voxels in the middle
// of a solid may have any number of these.
void FieldScan::List(const FieldContext& context, const Vec3i& brick_min) {
  constexpr size_t kMost = 256;
  constexpr double kHalf = 0.5 * (kBrickSide - 1) * kLatticeUnit;
  const Mat3d& root = context.plan.metric.root;
  list_.clear();
  has_list_ = std::isfinite(context.plan.most_square);
  if (!has_list_) return;
  const Vec3d middle = Apply(root, ToDouble(brick_min * kLatticeUnit) + Vec3d{kHalf, kHalf, kHalf});
  Vec3d half{1, 1, 1};  // more than rounding errors
  for (const Vec3d& step : root) {
    for (size_t m = 0; m < 3; ++m) half[m] += std::abs(step[m]) * kHalf;
  }
  const Vec3d low = middle - half, high = middle + half;
  double bound = context.plan.most_square;
  context.index->ForEachNear(low, high, bound, [&](uint32_t triangle) {
    Listed listed{{}, {}, triangle};
    const Triangle corners = context.mesh.TriangleAt(triangle);
    const std::array<Vec3d, 3> x{Apply(root, ToDouble(corners[0])), Apply(root, ToDouble(corners[1])),
                                 Apply(root, ToDouble(corners[2]))};
    double square = 0;
    for (size_t m = 0; m < 3; ++m) {
      listed.low[m] = std::min({x[0][m], x[1][m], x[2][m]}) - 1;
      listed.high[m] = std::max({x[0][m], x[1][m], x[2][m]}) + 1;
      const double beyond = std::max({listed.low[m] - high[m], low[m] - listed.high[m], 0.0});
      square += beyond * beyond;
    }
    if (square > bound) return;
    if (list_.size() < kMost) {
      list_.push_back(listed);
      return;
    }
    has_list_ = false;
    bound = -1;  // ends the search
  });
}

// Finds all triangles that may be at the smallest distance.
//   bound   not below the square of that distance, as TriangleDistance::SquareTo has it
void FieldScan::FindCandidates(const FieldContext& context, const Vec3i& point, double bound) {
  candidates_.clear();
  least_ = winner_ ? std::min(bound, winner_->SquareTo(point)) : bound;
  const Vec3d x = Apply(context.plan.metric.root, ToDouble(point));
  double limit = least_ * (1 + kDoubt);
  if (has_list_) {
    for (const Listed& listed : list_) {
      double square = 0;
      for (size_t m = 0; m < 3; ++m) {
        const double beyond = std::max({listed.low[m] - x[m], x[m] - listed.high[m], 0.0});
        square += beyond * beyond;
      }
      if (square <= limit) Offer(context, listed.triangle, point, limit);
    }
  } else {
    size_t visits = 0;
    context.index->ForEachNear(x, x, limit, [&](uint32_t number) {
      if (++visits % kVisits == 0 && context.stop.Stopped()) limit = -1;
      Offer(context, number, point, limit);
    });
  }
  std::erase_if(candidates_, [limit](const Candidate& candidate) { return candidate.square > limit; });
}

// `limit`: of squares; becomes lower with a nearer triangle.
void FieldScan::Offer(const FieldContext& context, uint32_t number, const Vec3i& point, double& limit) {
  const Metric& metric = context.plan.metric;
  const TriangleDistance& triangle = shapes_.At(context.mesh, metric, number);
  const Vec3d x = Apply(metric.root, ToDouble(point - triangle.corner())) - triangle.center();
  if (!MayComeWithin(triangle, x, limit)) return;
  const double square = triangle.SquareTo(point);
  if (square > limit) return;
  candidates_.push_back({square, number});
  if (square >= least_) return;
  least_ = square;
  limit = least_ * (1 + kDoubt);
}

// Finds the members of `nearest` after `square`. Returns false if the job was stopped before.
bool FieldScan::Decide(const FieldContext& context, Nearest& nearest) {
  assert(!candidates_.empty());
  const FieldPlan& plan = context.plan;
  const bool has_numbers = !plan.of_mesh.empty();
  if (plan.of_mesh.size() == plan.nearest.size() && AgreeOnNumbers(context, nearest)) return true;
  winner_.reset();
  Corner best{};
  for (const Candidate& candidate : candidates_) {
    if (winner_ && context.stop.Stopped()) return false;
    const TriangleDistance& shape = shapes_.At(context.mesh, plan.metric, candidate.triangle);
    std::optional<TriangleFeature> feature;
    if (candidates_.size() > 1) feature = shape.FeatureNear(nearest.point);
    const int order = winner_ ? CompareWithWinner(shape, feature, nearest.point) : -1;
    if (order > 0) continue;
    const bool comes_first = order < 0 || std::pair(!shape.has_area(), candidate.triangle) <
                                              std::pair(!winner_->has_area(), nearest.triangle);
    if (comes_first) {
      winner_.emplace(shape);
      feature_ = feature;
      nearest.triangle = candidate.triangle;
    }
    if (!has_numbers) continue;
    const Corner corner = NearestCorner(context, candidate.triangle, nearest.point);
    if (order < 0 || corner.square < best.square) {
      best = corner;
    } else if (corner.square == best.square) {
      for (size_t n = 0; n < kMostMeshFields; ++n) best.numbers[n] = std::min(best.numbers[n], corner.numbers[n]);
    }
  }
  nearest.shape = &*winner_;
  if (has_numbers) nearest.numbers = best.numbers;
  return true;
}

// Which triangle is nearest matters to these only if their numbers differ. Mostly they have the same ones, because they
// are neighbors with a common corner or edge. Returns whether they have, and finds the numbers.
bool FieldScan::AgreeOnNumbers(const FieldContext& context, Nearest& nearest) {
  std::optional<Corner> first;
  for (const Candidate& candidate : candidates_) {
    const Corner corner = NearestCorner(context, candidate.triangle, nearest.point);
    if (!first) first = corner;
    if (corner.numbers != first->numbers) return false;
  }
  nearest.numbers = first->numbers;
  winner_.emplace(shapes_.At(context.mesh, context.plan.metric, candidates_.front().triangle));
  return true;
}

// Below 0: the triangle is nearer than the winner; 0: at the same distance.
int FieldScan::CompareWithWinner(const TriangleDistance& shape, const std::optional<TriangleFeature>& feature,
                                 const Vec3i& point) const {
  if (ShareNearestPoint(shape.corners(), *feature, winner_->corners(), *feature_)) return 0;
  return TriangleDistance::Compare(shape, *winner_, point);
}

FieldScan::Corner FieldScan::NearestCorner(const FieldContext& context, uint32_t triangle, const Vec3i& point) {
  const size_t count = context.plan.of_mesh.size();
  Corner nearest{-1, {}};
  for (const uint32_t vertex : context.mesh.triangles[triangle]) {
    const Vec3i d = point - context.mesh.vertices_lat[vertex];
    const __int128 square = Inner(context.plan.metric, d, d);
    if (nearest.square >= 0 && square > nearest.square) continue;
    const uint32_t* const offered = &context.plan.of_vertices[size_t{vertex} * count];
    const bool first = nearest.square < 0 || square < nearest.square;
    for (size_t n = 0; n < count; ++n) {
      nearest.numbers[n] = first ? offered[n] : std::min(nearest.numbers[n], offered[n]);
    }
    nearest.square = square;
  }
  return nearest;
}

}  // namespace latvox
