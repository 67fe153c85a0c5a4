// The fields of a tile's voxels.
#ifndef LATVOX_CORE_FIELDS_FIELD_SCAN_H_
#define LATVOX_CORE_FIELDS_FIELD_SCAN_H_

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/band/triangle_distance.h"
#include "core/base/stop_signal.h"
#include "core/brick/brick.h"
#include "core/fields/field_writer.h"
#include "core/fields/near_numbers.h"
#include "core/fields/plan.h"
#include "core/fields/shape_cache.h"
#include "core/fields/triangle_index.h"
#include "core/snap/snap.h"
#include "core/solid/interior.h"

namespace latvox {

struct PlacedWriter {
  size_t place;  // of its field in TileBricks::fields
  std::unique_ptr<FieldWriter> writer;
};

// The facts that all tiles of a job share.
struct FieldContext {
  const SnappedMesh& mesh;
  const FieldPlan& plan;
  const TriangleIndex* index;  // null unless plan.is_searched without plan.near_reach
  std::vector<PlacedWriter> writers;
  StopSignal stop;
};

// Each thread has its own, and reuses it from tile to tile. It takes some 0.5 MiB, and 16 bytes for each triangle that
// is equally near to one voxel. With plan.near_reach, it takes two times NearNumbers::kBytesPerTriangle for each
// triangle near the tile.
//
// The scan decides exactly on the nearest triangle. Doubles sort out most triangles. Two triangles with the same
// nearest corner or edge are at the same distance. Integers compare all others. So fields do not depend on tiles,
// threads or kernels. Only numbers of triangles depend on the order of triangles.
class FieldScan {
 public:
  // Finds those of tile.fields that come from the nearest triangle, which are incomplete once the job is stopped. Takes
  // tile.squares away.
  //   triangles   all that meet the tile, for signs; with plan.near_reach, also those within that reach of its points
  //   interior    null, or that which decides on signs
  void Find(const FieldContext& context, std::span<const uint32_t> triangles, const Interior* interior,
            TileBricks& tile);

 private:
  // A triangle that may be the nearest.
  struct Candidate {
    double square;  // as TriangleDistance::SquareTo
    uint32_t triangle;
  };

  // The smallest numbers among the corners of a triangle that are nearest to a point.
  struct Corner {
    __int128 square;  // of the distance, as of Inner
    std::array<uint32_t, kMostMeshFields> numbers;
  };

  // A triangle near a brick, with its box as in TriangleIndex.
  struct Listed {
    Vec3d low, high;
    uint32_t triangle;
  };

  void FindBrick(const FieldContext& context, const Brick& brick, const double*& square, TileBricks& tile);
  void FindNearBrick(const FieldContext& context, const Brick& brick, TileBricks& tile);
  bool FindNumbers(const FieldContext& context, const Vec3i& voxel, Nearest& nearest);
  static bool AppendLabels(const Brick& brick, const TileBricks& tile, std::optional<uint32_t> elsewhere,
                           std::vector<std::byte>& out);
  static void AppendCopies(const FieldContext& context, const Brick& brick, std::span<const uint32_t> numbers,
                           TileBricks& tile);
  bool RepeatsNumbers(const FieldContext& context, Nearest& nearest);
  void List(const FieldContext& context, const Vec3i& brick_min);
  void FindCandidates(const FieldContext& context, const Vec3i& point, double bound);
  void Offer(const FieldContext& context, uint32_t number, const Vec3i& point, double& limit);
  bool Decide(const FieldContext& context, Nearest& nearest);
  bool AgreeOnNumbers(const FieldContext& context, Nearest& nearest);
  int CompareWithWinner(const TriangleDistance& shape, const std::optional<TriangleFeature>& feature,
                        const Vec3i& point) const;
  static Corner NearestCorner(const FieldContext& context, uint32_t triangle, const Vec3i& point);

  Vec3i tile_min_{};  // local
  InteriorRows inside_;
  bool has_inside_ = false;
  ShapeCache shapes_;
  NearNumbers bricks_{kBrickBits}, voxels_{0};  // of the tile and of a brick, with plan.near_reach
  // All triangles that may be the nearest to a voxel of the brick, if these are few.
  std::vector<Listed> list_;
  bool has_list_ = false;
  std::vector<Candidate> candidates_;
  double least_ = 0;  // the smallest square among them
  // The nearest triangle so far, also of the voxel before.
  std::optional<TriangleDistance> winner_;
  std::optional<TriangleFeature> feature_;           // of winner_
  std::array<uint32_t, kMostMeshFields> numbers_{};  // that the search found last
  bool is_new_winner_ = false;                       // no voxel has repeated its numbers
  int pause_ = 0;                                    // voxels until numbers may be repeated
};

}  // namespace latvox

#endif  // LATVOX_CORE_FIELDS_FIELD_SCAN_H_
