#include "client/tool/confined/hdf5_info.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/tool/hdf5/descriptor_driver.h"
#include "client/tool/hdf5/hdf5_attribute.h"
#include "client/tool/hdf5/hdf5_library.h"
#include "client/tool/output/box_shape.h"
#include "latvox/for_each_voxel.h"

namespace latvox::client {
namespace {

constexpr char kVoxels[] = "/sets/voxels";

// Reads rows of an array, some at a time.
class Array {
 public:
  Array(const Hdf5& hdf5, hid_t file, const std::string& name, hid_t type, hsize_t columns)
      : hdf5_(hdf5), type_(type), set_(hdf5.H5Dopen2(file, name.c_str(), H5P_DEFAULT), hdf5.H5Dclose) {
    if (!set_.ok()) return;
    const Hdf5Id space(hdf5.H5Dget_space(set_.get()), hdf5.H5Sclose);
    if (!space.ok() || hdf5.H5Sget_simple_extent_ndims(space.get()) != 2) return;
    good_ = hdf5.H5Sget_simple_extent_dims(space.get(), shape_.data(), nullptr) == 2 && shape_[1] == columns;
  }

  bool good() const { return good_; }
  uint64_t rows() const { return shape_[0]; }

  bool Read(uint64_t first, uint64_t count, void* to) const {
    const std::array<hsize_t, 2> start = {first, 0}, now = {count, shape_[1]};
    const Hdf5Id file(hdf5_.H5Dget_space(set_.get()), hdf5_.H5Sclose);
    const Hdf5Id memory(hdf5_.H5Screate_simple(2, now.data(), nullptr), hdf5_.H5Sclose);
    return file.ok() && memory.ok() &&
           hdf5_.H5Sselect_hyperslab(file.get(), H5S_SELECT_SET, start.data(), nullptr, now.data(), nullptr) >= 0 &&
           hdf5_.H5Dread(set_.get(), type_, memory.get(), file.get(), H5P_DEFAULT, to) >= 0;
  }

 private:
  const Hdf5& hdf5_;
  const hid_t type_;
  Hdf5Id set_;
  std::array<hsize_t, 2> shape_{};
  bool good_ = false;
};

// Adds voxels and box of all bricks. Returns what is wrong with them, or "".
std::string CountBricks(const Hdf5& hdf5, hid_t file, GridFileInfo& info) {
  constexpr uint64_t kPiece = 4096;
  constexpr int32_t kFarthest = 1 << 28;  // so that coordinates of voxels have 32 bits
  const Array ijk(hdf5, file, absl::StrCat(kVoxels, "/ijk"), hdf5.H5T_STD_I32LE_g, 3);
  const Array brick_ijk(hdf5, file, absl::StrCat(kVoxels, "/brick_ijk"), hdf5.H5T_STD_I32LE_g, 3);
  const Array masks(hdf5, file, absl::StrCat(kVoxels, "/brick_mask"), hdf5.H5T_STD_U64LE_g, 8);
  if (!ijk.good() || !brick_ijk.good() || !masks.good() || brick_ijk.rows() != masks.rows()) return "has no voxels";
  std::vector<Vec3i> corners(kPiece);
  std::vector<decltype(Brick::mask)> bits(kPiece);
  VoxelBox box;
  for (uint64_t first = 0; first < masks.rows(); first += kPiece) {
    const uint64_t now = std::min(kPiece, masks.rows() - first);
    if (!brick_ijk.Read(first, now, corners.data()) || !masks.Read(first, now, bits.data()))
      return "has damaged bricks";
    for (size_t n = 0; n < now; ++n) {
      for (const int32_t x : corners[n]) {
        if (x < -kFarthest || x >= kFarthest) return "has a brick out of range";
      }
      const Brick brick{corners[n], bits[n]};
      info.active_voxels += CountVoxels(brick);
      box.Add(brick);
    }
  }
  if (info.active_voxels != ijk.rows()) return "has bricks of another number of voxels";
  info.active_box = box.box();
  return "";
}

// Returns the names in a group, or none without it.
std::vector<std::string> NamesIn(const Hdf5& hdf5, hid_t file, const char* group) {
  std::vector<std::string> names;
  if (hdf5.H5Lexists(file, group, H5P_DEFAULT) <= 0) return names;
  const Hdf5Id opened(hdf5.H5Gopen2(file, group, H5P_DEFAULT), hdf5.H5Gclose);
  const auto add = [](hid_t, const char* name, const H5L_info_t*, void* all) -> herr_t {
    static_cast<std::vector<std::string>*>(all)->emplace_back(name);
    return 0;
  };
  if (opened.ok()) hdf5.H5Literate(opened.get(), H5_INDEX_NAME, H5_ITER_INC, nullptr, add, &names);
  return names;
}

std::string ReadInto(const Hdf5& hdf5, hid_t file, GridFileInfo& info) {
  const Hdf5Attributes root(hdf5, file);
  int32_t version = 0;
  std::array<Vec3d, 3> steps{};
  if (!root.Read("format_version", &version, 1) || version != 1) return "is not a file of latvox";
  if (!root.Read("basis", steps[0].data(), 9) || !root.Read("origin", info.transform.origin.data(), 3) ||
      !root.Read("voxel_size", &info.transform.voxel_size, 1)) {
    return "does not tell where its voxels are";
  }
  info.transform.basis = {steps[0], steps[1], steps[2]};
  if (!root.ReadTexts(info.metadata)) return "has damaged attributes";
  std::erase_if(info.metadata, [](const auto& entry) { return !absl::StartsWith(entry.first, "latvox_"); });
  info.name = "voxels";
  std::vector<std::string> parts = NamesIn(hdf5, file, "fields");
  if (!NamesIn(hdf5, file, "links").empty()) parts.emplace_back("links");
  info.value_type = parts.empty() ? "no fields" : absl::StrJoin(parts, ", ");
  return CountBricks(hdf5, file, info);
}

}  // namespace

absl::StatusOr<GridFileInfo> ReadHdf5Info(int fd, const std::string& path) {
  const auto hdf5 = Hdf5::Load();
  const auto bad = [&path](absl::string_view why) { return absl::InvalidArgumentError(absl::StrCat(path, ": ", why)); };
  if (!hdf5.ok()) return absl::Status(hdf5.status().code(), absl::StrCat(path, ": ", hdf5.status().message()));
  const Hdf5Id access = AccessBy(**hdf5, {fd, nullptr});
  constexpr unsigned kReadOnly = 0;  // H5F_ACC_RDONLY, which would call the library
  const Hdf5Id file((*hdf5)->H5Fopen("latvox", kReadOnly, access.get()), (*hdf5)->H5Fclose);
  if (!file.ok()) return bad("is not a readable .h5 file");
  GridFileInfo info;
  if (const std::string wrong = ReadInto(**hdf5, file.get(), info); !wrong.empty()) return bad(wrong);
  return info;
}

}  // namespace latvox::client
