#include "client/grid/grid_transform.h"

#include <cmath>
#include <cstdint>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "latvox/error.h"
#include "latvox/grid/voxel_grid.h"

namespace latvox::client {
namespace {

// OpenVDB's limits: numbers that are no farther apart count as equal, and voxels of a smaller volume as none.
constexpr double kTolerance = 1e-15, kLeastVolume = 3 * kTolerance;

double Determinant(const Basis& basis) {
  const auto& [a, b, c] = basis;
  return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

bool IsDiagonal(const Basis& basis) {
  const auto& [a, b, c] = basis;
  const double others =
      std::abs(a[1]) + std::abs(a[2]) + std::abs(b[0]) + std::abs(b[2]) + std::abs(c[0]) + std::abs(c[1]);
  return others <= kTolerance;
}

bool IsUniform(const Vec3d& scale) {
  return std::abs(scale[0] - scale[1]) <= kTolerance && std::abs(scale[0] - scale[2]) <= kTolerance;
}

std::string Bytes(const std::string& type, const std::vector<double>& numbers) {
  const auto size = static_cast<uint32_t>(type.size());
  std::string bytes(reinterpret_cast<const char*>(&size), sizeof(size));
  bytes += type;
  return bytes.append(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(double));
}

// A scale map: the origin, unless it is 0; scale, voxel size, inverses, their squares and halves.
std::string ScaleBytes(Vec3d scale, const Vec3d& origin) {
  const bool is_uniform = IsUniform(scale), has_origin = origin != Vec3d{};
  if (is_uniform) scale = {scale[0], scale[0], scale[0]};
  std::vector<double> numbers;
  const auto append = [&numbers, &scale](auto number) {
    for (const double x : scale) numbers.push_back(number(x));
  };
  if (has_origin) numbers.assign(origin.begin(), origin.end());
  append([](double x) { return x; });
  append([](double x) { return std::abs(x); });
  append([](double x) { return 1 / x; });
  append([](double x) { return (1 / x) * (1 / x); });
  append([](double x) { return 1 / x / 2; });
  return Bytes(absl::StrCat(is_uniform ? "Uniform" : "", "Scale", has_origin ? "Translate" : "", "Map"), numbers);
}

}  // namespace

absl::Status CheckGridTransform(const GridTransform& transform) {
  if (std::abs(Determinant(transform.basis)) >= kLeastVolume) return absl::OkStatus();
  const std::string value = absl::StrFormat("%.6g", transform.voxel_size);
  const std::string limit = absl::StrFormat("%.6g", std::cbrt(kLeastVolume));
  absl::Status status = absl::InvalidArgumentError(
      absl::StrCat("voxel_size ", value, " is below ", limit, ", the least that a .vdb file's transform takes"));
  SetErrorDetails({"VOXEL_SIZE_OUT_OF_RANGE", "voxel_size", value, limit, std::nullopt}, status);
  return status;
}

// OpenVDB multiplies row vectors: (i, j, k, 1) * M, so the basis vectors and the origin are M's rows.
std::string TransformBytes(const GridTransform& transform) {
  const auto& [a, b, c] = transform.basis;
  const Vec3d& o = transform.origin;
  if (IsDiagonal(transform.basis)) return ScaleBytes({a[0] + b[0] + c[0], a[1] + b[1] + c[1], a[2] + b[2] + c[2]}, o);
  return Bytes("AffineMap", {a[0], a[1], a[2], 0, b[0], b[1], b[2], 0, c[0], c[1], c[2], 0, o[0], o[1], o[2], 1});
}

}  // namespace latvox::client
