// Facts about a mesh, from a walk.
#ifndef LATVOX_CORE_WALK_FACTS_H_
#define LATVOX_CORE_WALK_FACTS_H_

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/vec.h"

namespace latvox {

// The largest box that a way is searched in: two bytes for each point.
inline constexpr uint64_t kMostLeakPoints = uint64_t{1} << 25;
// The most points of a way that are kept: those around the narrowest.
inline constexpr size_t kMostLeakSteps = 4096;

// With `close`, what a walk keeps for a tile that it reaches in part.
inline constexpr uint32_t kBytesPerReachedTile = 32 << 10;

struct Leak {
  enum Kind {
    kNone,        // the point is enclosed
    kInWall,      // it lies in the surface, or too near to the mesh
    kFound,       // it is not enclosed; the other members say where a way leads
    kBoxTooLarge  // it is not enclosed; the mesh's box has more than kMostLeakPoints
  };
  Kind kind = kNone;
  Vec3i from{};             // the lattice point, global
  uint64_t steps = 0;       // of the way
  std::vector<Vec3i> path;  // global, from the point to the first one outside of the mesh's box
  Vec3i narrowest{};        // global: the point of the way with the least room
  Vec3d narrowest_world{};
  double room = 0;  // world units: the distance of that point from the mesh
  uint64_t box_points = 0;
};

// The facts of one of several labels.
struct LabelWalkFacts {
  uint32_t label = 0;
  uint64_t cavities = 0, points = 0;  // points: of all cavities
  std::optional<Leak> leak;           // of the point that the request names
};

struct WalkFacts {
  uint64_t cavities = 0;               // connected sets of points that no walk from outside reaches
  uint64_t points = 0;                 // of all of these
  std::vector<uint64_t> largest;       // their numbers of points, descending: at most kMostCavities
  std::optional<Leak> leak;            // of the point that the request names; not with labels
  std::vector<LabelWalkFacts> labels;  // of a labeled set, ascending; then the members above are sums over these
};
inline constexpr size_t kMostCavities = 16;
// The search for leaks takes labels in order of priority. It ends after so many that do not enclose the point.
inline constexpr size_t kMostLeaks = 8;

}  // namespace latvox

#endif  // LATVOX_CORE_WALK_FACTS_H_
