// Jobs of every kind, for tests of their common promises.
#ifndef LATVOX_TESTS_UNIT_CORE_JOB_KINDS_H_
#define LATVOX_TESTS_UNIT_CORE_JOB_KINDS_H_

#include <array>
#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/voxelizer/voxelizer.h"

namespace latvox {

struct JobKind {
  std::string name;
  uint32_t tetrahedra;  // of a heap that takes one thread two tenths of a second with assertions on
  VoxelizeOptions options;
  NamedLattice lattice = NamedLattice::kCartesian;

  // Makes a job of a mesh; its vertices get numbers if the kind has fields of the mesh. Those of a labeled solid that
  // must be closed are the same for the four corners of a tetrahedron.
  std::unique_ptr<VoxelizeJob> Job(TriangleMesh mesh) const {
    for (size_t n = 0; n < mesh.vertices.size() * options.fields.OfMesh().size(); ++n) {
      mesh.attributes.push_back(static_cast<uint32_t>(HasClosedLabels() ? n / 4 % 7 : n % 7));
    }
    return *VoxelizeJob::Create(std::move(mesh), {Lattice::Named(lattice), {0, 0, 0}}, options);
  }
  bool HasClosedLabels() const {
    const Solid* const solid = std::get_if<Solid>(&options.set);
    return solid != nullptr && solid->labels && !solid->force_open;
  }
};

inline std::vector<JobKind> JobKinds() {
  return {{"k = 0", 40000, {}},
          {"k = 2", 120000, {.separability = 2}},
          {"BCC", 32000, {}, NamedLattice::kBcc},
          {"band", 2000, {.set = Band{2, true}}},
          {"signed band", 2000, {.set = Band{2, true}, .fields = {Field::kDistance}, .signed_distance = true}},
          {"band with fields", 1500, {.set = Band{2, true}, .fields = {Field::kTriangle, Field::kNormal}}},
          {"band with links and fractions",
           1000,
           {.set = Band{2, true}, .fields = {Field::kLinks, Field::kFraction}, .fraction_n = 4}},
          {"solid", 40000, {.set = Solid{}}},
          {"open solid", 40000, {.set = Solid{.rule = InteriorRule::kWinding, .force_open = true}}},
          {"fields of the mesh", 8000, {.fields = {Field::kPart, Field::kMaterial}}},
          {"fields", 6000, {.fields = {Field::kTriangle, Field::kPoint, Field::kNormal}}},
          {"solid with fields", 4000, {.set = Solid{}, .fields = {Field::kPart, Field::kDistance}}},
          {"labeled solid", 30000, {.set = Solid{.labels = Field::kPart}, .fields = {Field::kPart}}},
          {"open labeled solid",
           30000,
           {.set = Solid{.force_open = true, .labels = Field::kPart}, .fields = {Field::kPart}}},
          {"enclosed", 20000, {.set = Enclosed{}}},
          {"region", 20000, {.set = Connected{{-5, -5, -5}, 0, true}}},
          {"closed holes", 1500, {.set = Enclosed{.close = 2.5}}},
          {"region with closed holes", 1500, {.set = Connected{{-5, -5, -5}, 2.5, true}}},
          {"labeled enclosed", 8000, {.set = Enclosed{.labels = Field::kPart}, .fields = {Field::kPart}}},
          {"enclosed with fields", 2000, {.set = Enclosed{}, .fields = {Field::kDistance}}},
          {"enclosed with signed distances",
           1500,
           {.set = Enclosed{}, .fields = {Field::kDistance}, .signed_distance = true}},
          {"labeled enclosed with closed holes",
           1000,
           {.set = Enclosed{.close = 2.5, .labels = Field::kPart}, .fields = {Field::kPart}}},
          {"links", 12000, {.set = Links{}}},
          {"outer links", 4000, {.set = Links{LinkSide::kOutside}, .fields = {Field::kLinks, Field::kLinkTriangles}}},
          {"solid with links", 4000, {.set = Solid{}, .fields = {Field::kLinkCrossings, Field::kPart}}},
          {"solid with fractions", 3000, {.set = Solid{}, .fields = {Field::kFraction}, .fraction_n = 4}},
          {"labeled solid with fractions",
           2000,
           {.set = Solid{.labels = Field::kPart}, .fields = {Field::kPart, Field::kLabelFractions}, .fraction_n = 4}},
          {"supercover", 28000, {.set = SupercoverSurface{}}},
          {"supercover with fields", 5000, {.set = SupercoverSurface{}, .fields = {Field::kPart, Field::kNormal}}},
          {"brute force", 1500, {.algorithm = Algorithm::kBruteForce}},
          {"incremental", 10000, {.algorithm = Algorithm::kIncremental}},
          {"optimized incremental", 10000, {.algorithm = Algorithm::kOptimizedIncremental}}};
}

// Tetrahedra up to 2 `size` voxels wide, in a cube of `side` voxels, by default in a single tile. The four faces of
// each are a closed surface.
inline TriangleMesh HeapOfTetrahedra(uint32_t count, float side = 40, float size = 2) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> place(0, side), corner(-size, size);
  TriangleMesh heap;
  for (uint32_t n = 0; n < 4 * count; n += 4) {
    const Vec3f at{place(random), place(random), place(random)};
    for (int c = 0; c < 4; ++c) {
      heap.vertices.push_back({at[0] + corner(random), at[1] + corner(random), at[2] + corner(random)});
    }
    for (const auto& [a, b, c] : {std::array{0U, 1U, 2U}, {0U, 2U, 3U}, {0U, 3U, 1U}, {1U, 3U, 2U}}) {
      heap.triangles.push_back({n + a, n + b, n + c});
    }
  }
  return heap;
}

}  // namespace latvox

#endif  // LATVOX_TESTS_UNIT_CORE_JOB_KINDS_H_
