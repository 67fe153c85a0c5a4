// A whole request, from the bytes of its specification to voxels: validation, grid, snapping, tiles, thinning.
#include <fuzzer/FuzzedDataProvider.h>

#include <cstdint>
#include <cstdlib>

#include "core/snap/mesh_range.h"
#include "core/voxelizer/estimate.h"
#include "server/wire/convert.h"

namespace {

// Few triangles, with coordinates that collide often.
latvox::TriangleMesh MakeMesh(FuzzedDataProvider& data) {
  latvox::TriangleMesh mesh;
  const auto vertices = data.ConsumeIntegralInRange<uint32_t>(1, 12);
  for (uint32_t n = 0; n < vertices; ++n) {
    latvox::Vec3f v;
    for (float& x : v) {
      x = data.ConsumeBool() ? static_cast<float>(data.ConsumeIntegralInRange(-64, 64)) / 4
                             : data.ConsumeFloatingPoint<float>();
    }
    mesh.vertices.push_back(v);
  }
  const auto triangles = data.ConsumeIntegralInRange<uint32_t>(0, 20);
  for (uint32_t n = 0; n < triangles; ++n) {
    const auto vertex = [&] { return data.ConsumeIntegralInRange<uint32_t>(0, vertices); };  // one is out of range
    mesh.triangles.push_back({vertex(), vertex(), vertex()});
  }
  return mesh;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  FuzzedDataProvider data(bytes, size);
  latvox::TriangleMesh mesh = MakeMesh(data);
  latvox::v1::VoxelizeSpec proto;
  const std::string rest = data.ConsumeRemainingBytesAsString();
  if (!proto.ParseFromString(rest)) return 0;
  const auto spec = latvox::JobSpecFromProto(proto, latvox::Limits());
  if (!spec.ok()) return 0;
  // As a decoder would give them.
  const uint32_t numbers = spec->request.fields.OfMesh().size();
  for (size_t n = 0; n < mesh.vertices.size() * numbers; ++n) mesh.attributes.push_back(static_cast<uint32_t>(n % 5));
  if (!latvox::CheckMesh(mesh).ok()) return 0;
  // The other algorithms promise neither separation nor an early first tile.
  if (spec->request.algorithm() != latvox::Algorithm::kExact) return 0;
  const auto grid = latvox::ResolveGrid(spec->grid.lattice, spec->grid.sampling, spec->grid.origin,
                                        latvox::BoundsOf(mesh), spec->placement);
  if (!grid.ok()) return 0;
  const latvox::Solid* const solid = spec->request.solid();
  // Before the first tile, the job counts the crossings of all lines of a mesh that is not closed.
  constexpr double kManyVoxels = 1e6;
  const latvox::WalkSet* const walk = spec->request.walk();
  // A walk looks at the whole mesh before the first tile.
  if (walk != nullptr && latvox::EstimateVisits(mesh, latvox::ExtentOf(mesh), *grid, spec->request) > kManyVoxels)
    return 0;
  if (solid != nullptr && latvox::EstimateVoxels(mesh, latvox::ExtentOf(mesh), *grid, spec->request) > kManyVoxels)
    return 0;
  // Fractions find the inside on a finer lattice.
  if (spec->request.fraction_n != 0 &&
      latvox::EstimateVisits(mesh, latvox::ExtentOf(mesh), *grid, spec->request) > kManyVoxels)
    return 0;
  const auto job = latvox::VoxelizeJob::CreateFromValid(mesh, *grid, spec->request);
  if (!job.ok()) return 0;

  const size_t neighbors = 2 * grid->lattice.frames(spec->request.separability).size();
  int tiles = 0;
  latvox::VoxelSet voxels;
  const auto done = (*job)->Advance([&](latvox::TileBricks&& tile) {
    for (const latvox::Brick& brick : tile.bricks) voxels.Add(brick);
    if (tile.fields.size() != spec->request.fields.size() || !tile.labels.empty()) std::abort();
    for (size_t n = 0; n < tile.fields.size(); ++n) {
      const size_t bytes =
          latvox::FactsOf(spec->request.fields.view()[n]).bytes(neighbors, (*job)->facts().fraction_labels.size());
      if (tile.fields[n].size() != tile.voxels * bytes) std::abort();
    }
    if (++tiles == 8) (*job)->Cancel();  // the lattice may be huge
    return true;
  });
  if (!done.ok() || spec->request.part.region || spec->request.part.bounds || spec->request.part.shard ||
      spec->request.part.resume_after || (solid != nullptr && !spec->request.has_surface()) ||
      spec->request.band() != nullptr || spec->request.links() != nullptr || walk != nullptr)
    return 0;
  const auto verdict = (*job)->Verify(voxels);
  if (!verdict.ok() || verdict->tunnels != 0) std::abort();
  if (spec->request.is_minimal() && solid == nullptr && verdict->redundant != 0) std::abort();
  return 0;
}
