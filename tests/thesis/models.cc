#include "tests/thesis/models.h"

#include <chrono>

#include "absl/strings/str_format.h"
#include "core/base/stop_signal.h"
#include "core/snap/mesh_range.h"
#include "tests/thesis/measure.h"

namespace latvox::thesis {
namespace {

Grid GridFor(const TriangleMesh& mesh, const ModelCase& model_case) {
  const Bounds bounds = BoundsOf(mesh);
  const bool bcc = model_case.lattice_case.numbering == Numbering::kBcc;
  // Half cells on BCC, because LatticeCases' basis has cells of edge 2.
  const int32_t layers = bcc ? 2 * model_case.size : model_case.size;
  const double step = bounds.LongestSide() / (layers - 1);
  Mat3d basis = model_case.lattice_case.lattice.basis();
  for (Vec3d& column : basis) column = column * step;
  return {Lattice::FromBasis(basis).value(), bounds.min};
}

}  // namespace

std::string ModelCase::Title() const {
  if (lattice_case.numbering == Numbering::kBcc) return absl::StrFormat("BCC, %dx%dx%d", size, size, 2 * size);
  return absl::StrFormat("Cartesian, k=%d, %d^3", lattice_case.k, size);
}

std::vector<ModelCase> ModelCases() {
  const std::vector<LatticeCase> cases = LatticeCases();
  return {{cases[2], 256}, {cases[3], 180}, {cases[3], 203}, {cases[1], 256}, {cases[0], 256}};
}

ModelResult MeasureModel(const TriangleMesh& mesh, const ModelCase& model_case, Algorithm algorithm) {
  using Clock = std::chrono::steady_clock;
  const Grid grid = GridFor(mesh, model_case);
  const int k = model_case.lattice_case.k;
  const auto& frames = grid.lattice.frames(k);
  const SnappedMesh snapped = Snap(mesh, grid.lattice, grid.origin, {2, 2, 2}).value();

  ModelResult result;
  const auto start = Clock::now();
  const VoxelSet voxels = VoxelsBy(algorithm, mesh, grid, k);
  result.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  result.voxels = voxels.size();
  result.given = CountTunnels(snapped, frames, voxels, StopSignal()).value();
  result.rounded = CountTunnels(Rounded(snapped, grid.lattice), frames, voxels, StopSignal()).value();
  return result;
}

}  // namespace latvox::thesis
