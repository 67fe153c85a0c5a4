#include "core/verify/minimality.h"

#include <algorithm>
#include <tuple>

namespace latvox {
namespace {

bool ByVoxelAndPlane(const PlaneVoxel& a, const PlaneVoxel& b) {
  return std::tie(a.ijk, a.plane) < std::tie(b.ijk, b.plane);
}

bool IsUnderAnotherPlane(const std::vector<PlaneVoxel>& voxels, const Vec3i& ijk, uint32_t plane) {
  auto entry = std::lower_bound(voxels.begin(), voxels.end(), PlaneVoxel{ijk, {}, 0}, ByVoxelAndPlane);
  for (; entry != voxels.end() && entry->ijk == ijk; ++entry) {
    if (entry->plane != plane) return true;
  }
  return false;
}

}  // namespace

double Minimality::Ratio() const {
  const uint64_t counted = minimal + redundant;
  return counted == 0 ? 0 : 1 - static_cast<double>(minimal) / static_cast<double>(counted);
}

Minimality MeasureMinimality(std::vector<PlaneVoxel> voxels, const Flood& flood) {
  std::sort(voxels.begin(), voxels.end(), ByVoxelAndPlane);
  Minimality measured;
  for (auto first = voxels.begin(); first != voxels.end();) {
    const auto last = std::find_if(first, voxels.end(), [&](const PlaneVoxel& v) { return v.ijk != first->ijk; });
    const PlaneVoxel& voxel = *first;
    const bool at_seam = std::any_of(first, last, [&](const PlaneVoxel& v) { return v.plane != voxel.plane; });
    first = last;

    const Vec3i ends[2] = {voxel.ijk + voxel.direction, voxel.ijk - voxel.direction};
    const Label up = flood.At(ends[0]).value_or(Label::kWater), down = flood.At(ends[1]).value_or(Label::kWater);
    const bool other_surface = std::any_of(std::begin(ends), std::end(ends), [&](const Vec3i& end) {
      return IsUnderAnotherPlane(voxels, end, voxel.plane);
    });
    ++measured.voxels;
    if (at_seam) {
      ++measured.at_seam;
    } else if ((up == Label::kInside && down == Label::kWater) || (up == Label::kWater && down == Label::kInside)) {
      ++measured.minimal;
    } else if (other_surface) {
      ++measured.by_other_surface;
    } else {
      ++measured.redundant;
    }
  }
  return measured;
}

}  // namespace latvox
