#include "core/mesh/mesh.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>
#include <span>

#include "absl/strings/str_format.h"

namespace latvox {

double Bounds::LongestSide() const {
  const Vec3d side = max - min;
  return std::max({side[0], side[1], side[2]});
}

namespace {

// These loops have no branches, and only an OR carries over from step to step, so that compilers can vectorize them.
static_assert(sizeof(Vec3f) == 3 * sizeof(float) && sizeof(std::array<uint32_t, 3>) == 3 * sizeof(uint32_t));
bool AreFinite(std::span<const Vec3f> vertices) {
  const std::span numbers(vertices.front().data(), 3 * vertices.size());
  uint32_t infinite = 0;
  for (const float x : numbers) infinite |= (std::bit_cast<uint32_t>(x) & 0x7FFFFFFF) >= 0x7F800000 ? 1 : 0;
  return infinite == 0;
}

bool AreFinite(std::span<const Vec3d> vertices) {
  constexpr uint64_t kInfinity = 0x7FF0000000000000, kMagnitude = 0x7FFFFFFFFFFFFFFF;
  const std::span numbers(vertices.front().data(), 3 * vertices.size());
  uint64_t infinite = 0;
  for (const double x : numbers) infinite |= (std::bit_cast<uint64_t>(x) & kMagnitude) >= kInfinity ? 1 : 0;
  return infinite == 0;
}

bool AreBelow(size_t count, std::span<const std::array<uint32_t, 3>> triangles) {
  if (count == 0) return false;
  const auto last = static_cast<uint32_t>(std::min(count - 1, size_t{UINT32_MAX}));
  const std::span indices(triangles.front().data(), 3 * triangles.size());
  uint32_t above = 0;
  for (const uint32_t index : indices) above |= index > last ? 1 : 0;
  return above == 0;
}

// Names the first element that is not valid.
template <class Vertices>
absl::Status Complain(const TriangleMesh& mesh, const Vertices& vertices) {
  for (size_t v = 0; v < vertices.size(); ++v) {
    for (const auto x : vertices[v]) {
      if (!std::isfinite(x)) return absl::InvalidArgumentError(absl::StrFormat("mesh: vertex %d is not finite", v));
    }
  }
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (uint32_t v : mesh.triangles[t]) {
      if (v >= vertices.size()) {
        return absl::InvalidArgumentError(
            absl::StrFormat("mesh: triangle %d uses vertex %d of %d", t, v, vertices.size()));
      }
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status CheckMesh(const TriangleMesh& mesh, StopSignal stop) {
  if (mesh.triangles.empty()) return absl::InvalidArgumentError("mesh: it has no triangles");
  using Part = oneapi::tbb::blocked_range<size_t>;
  constexpr size_t kGrain = 16384;  // vertices or triangles for each task
  std::atomic<bool> valid = true;
  return VisitVertices(mesh, [&](const auto& vertices) {
    oneapi::tbb::parallel_for(Part(0, vertices.size(), kGrain), [&](const Part& part) {
      if (!stop.Stopped() && !AreFinite(std::span(&vertices[part.begin()], part.size()))) valid = false;
    });
    oneapi::tbb::parallel_for(Part(0, mesh.triangles.size(), kGrain), [&](const Part& part) {
      if (!stop.Stopped() && !AreBelow(vertices.size(), {&mesh.triangles[part.begin()], part.size()})) valid = false;
    });
    return valid ? absl::OkStatus() : Complain(mesh, vertices);
  });
}

}  // namespace latvox
