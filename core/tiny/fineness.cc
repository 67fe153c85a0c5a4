#include "core/tiny/fineness.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "core/digitize/cell_box.h"
#include "core/tiny/line_forms.h"
#include "core/tiny/sift.h"
#include "core/tiny/tiny_cover.h"

namespace latvox {
namespace {

Vec3i TileOf(const Vec3i& corner) { return Shifted(corner, kSubvoxelBits + kTileBits); }

// Returns whether there are many triangles for each of their tiles, because tiles take memory. It counts all tiles that
// there may be, or, where a mesh lies in few of these, the number of samples in one tile.
bool AreDense(const SnappedMesh& mesh, std::vector<Vec3i> tiles_of_sample) {
  constexpr size_t kTrianglesATile = 8, kManyPairs = 16;
  size_t tiles = 1;
  for (size_t m = 0; m < 3; ++m) {
    tiles *= static_cast<size_t>(((mesh.box.max[m] - 1) >> kTileBits) - (mesh.box.min[m] >> kTileBits) + 1);
  }
  if (tiles * kTrianglesATile <= mesh.triangles.size()) return true;
  std::sort(tiles_of_sample.begin(), tiles_of_sample.end());
  size_t again = 0;
  for (size_t n = 1; n < tiles_of_sample.size(); ++n) again += tiles_of_sample[n] == tiles_of_sample[n - 1] ? 1 : 0;
  return again >= kManyPairs;
}

constexpr size_t kSample = 256, kManyTriangles = 16384;
using Sample = std::array<std::array<Vec3i, 3>, kSample>;

// Returns the corners of triangles spread over the mesh.
Sample SampleOf(const SnappedMesh& mesh) {
  const size_t count = mesh.triangles.size();
  // Read first, so that memory is waited for once.
  std::array<std::array<uint32_t, 3>, kSample> triangles;
  for (size_t n = 0; n < kSample; ++n) triangles[n] = mesh.triangles[n * count / kSample];
  Sample corners;
  for (size_t n = 0; n < kSample; ++n) {
    for (size_t c = 0; c < 3; ++c) corners[n][c] = mesh.vertices_lat[triangles[n][c]];
  }
  return corners;
}

}  // namespace

Fineness FinenessOf(const SnappedMesh& mesh, const std::vector<ScanFrame>& frames) {
  // A tiny triangle costs time for each line between its corners, another triangle mostly once.
  constexpr size_t kFewLines = 11;
  if (mesh.triangles.size() < kManyTriangles) return {};
  const LineForms all(frames);
  size_t touching = 0, tiny = 0, lines_of_tiny = 0;
  std::vector<Vec3i> tiles;
  for (const auto& [a, b, c] : SampleOf(mesh)) {
    tiles.push_back(TileOf(a));
    std::array<int32_t, kMaxForms> integers{};  // between a form's values at the corners
    for (size_t f = 0; f < all.forms.size(); ++f) {
      const auto floor = [&](const Vec3i& v) { return Dot(all.forms[f], v) >> kSubvoxelBits; };
      const auto [first, last] = std::minmax({floor(a), floor(b), floor(c)});
      integers[f] = last - first;
    }
    const bool is_tiny = *std::max_element(integers.begin(), integers.end()) <= kMostIntegers;
    bool touches = false;
    for (const LineForms::OfFrame& frame : all.of_frame) {
      const int32_t x = integers[frame.form[0]], y = integers[frame.form[1]];
      touches |= x > 0 && y > 0;
      if (is_tiny) lines_of_tiny += static_cast<size_t>(x * y);
    }
    tiny += is_tiny ? 1 : 0;
    touching += touches ? 1 : 0;
  }
  const bool few_touch = touching < kSample / 4 * 3;
  const bool most_tiny =
      tiny >= kSample / 16 * 9 && lines_of_tiny <= kFewLines * tiny && AreDense(mesh, std::move(tiles));
  return {few_touch, most_tiny};
}

bool IsFineForCover(const SnappedMesh& mesh) {
  if (mesh.triangles.size() < kManyTriangles) return false;
  size_t tiny = 0;
  std::vector<Vec3i> tiles;
  for (const Triangle& triangle : SampleOf(mesh)) {
    tiles.push_back(TileOf(triangle[0]));
    const IndexBox cells = BoxOfCells(triangle);
    const Vec3i side = cells.max - cells.min;
    tiny += std::max({side[0], side[1], side[2]}) <= kMostCells ? 1 : 0;
  }
  // A tiny triangle saves ten times what another costs.
  return tiny >= kSample / 4 && AreDense(mesh, std::move(tiles));
}

}  // namespace latvox
