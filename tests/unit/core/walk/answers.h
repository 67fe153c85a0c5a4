// Walks and their facts, for tests.
#ifndef LATVOX_TESTS_UNIT_CORE_WALK_ANSWERS_H_
#define LATVOX_TESTS_UNIT_CORE_WALK_ANSWERS_H_

#include <array>
#include <optional>

#include "core/voxelizer/voxelizer.h"
#include "tests/unit/core/exact.h"
#include "tests/unit/core/walk/flood.h"

namespace latvox {

inline oracle::Mesh Box(const Int3& low, const Int3& high) {
  const auto corner = [&](int n) {
    return Int3{(n & 4) != 0 ? high[0] : low[0], (n & 2) != 0 ? high[1] : low[1], (n & 1) != 0 ? high[2] : low[2]};
  };
  oracle::Mesh mesh;
  for (const auto& [a, b, c, d] : {std::array{0, 2, 6, 4}, std::array{1, 5, 7, 3}, std::array{0, 4, 5, 1},
                                   std::array{2, 3, 7, 6}, std::array{0, 1, 3, 2}, std::array{4, 6, 7, 5}}) {
    mesh.push_back({corner(a), corner(b), corner(c)});
    mesh.push_back({corner(a), corner(c), corner(d)});
  }
  return mesh;
}

struct Answer {
  absl::Status status;
  Points points;
  std::optional<WalkFacts> facts;
  IndexBox box;
};

inline Answer AnswerTo(const TriangleMesh& mesh, const Lattice& lattice, const VoxelizeOptions& options,
                       const Vec3i& shift) {
  Answer answer;
  auto job = VoxelizeJob::Create(mesh, Unscaled(lattice), options);
  answer.status = job.status();
  if (!job.ok()) return answer;
  answer.status = (*job)
                      ->Advance([&](TileBricks&& tile) {
                        for (const Brick& brick : tile.bricks) AddVoxels(brick, shift, answer.points);
                        return true;
                      })
                      .status();
  answer.facts = (*job)->facts().walk;
  answer.box = (*job)->facts().index_box.value_or(IndexBox{});
  return answer;
}

inline Vec3d WorldOf(const Lattice& lattice, const Vec3i& ijk) { return Apply(lattice.basis(), ToDouble(ijk)); }

inline const Lattice& Cartesian() {
  static const Lattice lattice = Lattice::Named(NamedLattice::kCartesian);
  return lattice;
}

}  // namespace latvox

#endif  // LATVOX_TESTS_UNIT_CORE_WALK_ANSWERS_H_
