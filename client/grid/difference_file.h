// The difference between two .vdb files as a .vdb file. Internal to latvox::grid and the tool.
#ifndef LATVOX_CLIENT_GRID_DIFFERENCE_FILE_H_
#define LATVOX_CLIENT_GRID_DIFFERENCE_FILE_H_

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "latvox/cancellation.h"
#include "latvox/types.h"

namespace latvox::client {

// The numbers of voxels in the grid "part".
enum class DifferenceMark : uint32_t { kSame, kOnlyA, kOnlyB, kOtherValues };

inline constexpr const char* kDifferenceNames[] = {"in both", "only in A", "only in B", "other values"};  // of each
inline const char* NameOf(DifferenceMark mark) { return kDifferenceNames[static_cast<size_t>(mark)]; }

// Voxels that differ. Numbers are in the order of BrickBatch.
struct GridDifference {
  std::string a, b;             // the compared files
  std::vector<Brick> bricks;    // the voxels
  std::vector<uint32_t> marks;  // of each
  bool has_distances = false;   // both files have distances
  std::vector<Brick> changed;   // then: the voxels of both files whose values differ
  std::vector<float> changes;   // of each, the distance in B minus that in A, world units
};

// Writes the grids "voxels" (the voxels that differ), "part" (their marks, with names: see latvox/grid/carried_names.h)
// and, with distances, "difference" (floats: the changes; 0 elsewhere). Metadata latvox_difference_a and
// latvox_difference_b name the files. Not atomic. Errors: UNKNOWN, with the path and OpenVDB's message;
// RESOURCE_EXHAUSTED (memory); CANCELLED.
absl::Status WriteDifferenceFile(const GridDifference& difference, const GridTransform& transform,
                                 const std::string& path, const Cancellation& cancellation);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_DIFFERENCE_FILE_H_
