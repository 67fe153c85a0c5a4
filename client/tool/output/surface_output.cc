#include "client/tool/output/surface_output.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/strings/str_cat.h"
#include "client/json/json.h"
#include "client/tool/output/field_columns.h"
#include "client/tool/output/voronoi_cell.h"
#include "latvox/for_each_voxel.h"

namespace latvox::client {
namespace {

// Constants of glTF 2.0 and its binary container: "glTF", version, length, then chunks of length, type and bytes.
constexpr uint32_t kGlbMagic = 0x46546C67, kGlbVersion = 2, kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;
constexpr int kUnsignedByte = 5121, kFloat = 5126, kUnsignedInt = 5125, kArrayBuffer = 34962,
              kElementArrayBuffer = 34963;
static_assert(std::endian::native == std::endian::little);

template <class T>
std::string_view BytesOf(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

void AppendWords(std::initializer_list<uint32_t> words, std::string& out) {
  for (const uint32_t word : words) out.append(reinterpret_cast<const char*>(&word), sizeof(word));
}

Vec3i IndexSum(const Vec3i& a, const Vec3i& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }

// Triangles. Voxels do not share corners.
struct Surface {
  Vec3d place{};  // world
  std::vector<std::array<float, 3>> corners;
  std::vector<std::array<uint32_t, 3>> triangles;
  std::vector<std::array<uint8_t, 4>> colors;  // red, green, blue, opacity of the corners; or empty
};

class VoxelLookup {
 public:
  void Add(const Brick& brick) { masks_[brick.brick_ijk] = brick.mask; }
  bool Has(const Vec3i& ijk) const {
    const auto found = masks_.find({ijk[0] >> 3, ijk[1] >> 3, ijk[2] >> 3});
    return found != masks_.end() &&
           (found->second[static_cast<size_t>(ijk[0] & 7)] >> ((ijk[1] & 7) << 3 | (ijk[2] & 7)) & 1) != 0;
  }

 private:
  absl::flat_hash_map<Vec3i, decltype(Brick::mask)> masks_;
};

// `colors` has one color per voxel, red << 16 | green << 8 | blue, or is empty.
Surface SurfaceOf(const std::vector<Brick>& bricks, const std::vector<uint32_t>& colors, const GridTransform& grid) {
  VoxelLookup voxels;
  for (const Brick& brick : bricks) voxels.Add(brick);
  const VoronoiCell cell = VoronoiCellOf(grid.basis);
  Surface surface;
  if (!bricks.empty()) {
    const Vec3i& b = bricks[0].brick_ijk;
    surface.place = grid.ToWorld({8 * b[0], 8 * b[1], 8 * b[2]});
  }
  constexpr uint32_t kNone = UINT32_MAX;
  std::vector<uint32_t> index(cell.corners.size());
  const auto add_voxel = [&](const Vec3i& ijk) {
    const Vec3d center = grid.ToWorld(ijk);
    std::fill(index.begin(), index.end(), kNone);
    const auto corner = [&](int n) {
      uint32_t& known = index[static_cast<size_t>(n)];
      if (known != kNone) return known;
      const Vec3d& offset = cell.corners[static_cast<size_t>(n)];
      std::array<float, 3> position{};
      for (size_t m = 0; m < 3; ++m) position[m] = static_cast<float>(center[m] - surface.place[m] + offset[m]);
      known = static_cast<uint32_t>(surface.corners.size());
      surface.corners.push_back(position);
      return known;
    };
    for (const CellFace& face : cell.faces) {
      if (voxels.Has(IndexSum(ijk, face.neighbor))) continue;
      for (size_t n = 2; n < face.corners.size(); ++n) {
        surface.triangles.push_back({corner(face.corners[0]), corner(face.corners[n - 1]), corner(face.corners[n])});
      }
    }
  };
  const uint32_t* color = colors.data();
  for (const Brick& brick : bricks) {
    ForEachVoxel(brick, [&](const Vec3i& ijk) {
      add_voxel(ijk);
      if (colors.empty()) return;
      const uint32_t n = *color++;
      surface.colors.resize(surface.corners.size(), {static_cast<uint8_t>(n >> 16), static_cast<uint8_t>(n >> 8),
                                                     static_cast<uint8_t>(n), 255});
    });
  }
  return surface;
}

// Without voxels the scene is empty, because glTF does not allow empty meshes.
Json Describe(const Surface& surface, const Summary& summary) {
  Json json = {{"asset", {{"version", "2.0"}, {"generator", "latvox " + summary.certificate.version}}},
               {"scene", 0},
               {"scenes", {Json::object()}}};
  json["extras"] = {{"voxels", summary.voxels},
                    {"lattice", summary.certificate.lattice},
                    {"separability", summary.certificate.separability},
                    {"digest", summary.certificate.digest}};
  if (surface.triangles.empty()) return json;
  std::array<float, 3> low = surface.corners[0], high = low;
  for (const auto& corner : surface.corners) {
    for (size_t m = 0; m < 3; ++m) {
      low[m] = std::min(low[m], corner[m]);
      high[m] = std::max(high[m], corner[m]);
    }
  }
  const size_t corners_bytes = BytesOf(surface.corners).size(), triangles_bytes = BytesOf(surface.triangles).size();
  json["scenes"][0]["nodes"] = {0};
  json["nodes"] = {{{"name", "voxels"}, {"mesh", 0}, {"translation", surface.place}}};
  json["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"indices", 1}}}}}};
  json["accessors"] = {{{"bufferView", 0},
                        {"componentType", kFloat},
                        {"count", surface.corners.size()},
                        {"type", "VEC3"},
                        {"min", low},
                        {"max", high}},
                       {{"bufferView", 1},
                        {"componentType", kUnsignedInt},
                        {"count", 3 * surface.triangles.size()},
                        {"type", "SCALAR"}}};
  json["bufferViews"] = {
      {{"buffer", 0}, {"byteLength", corners_bytes}, {"target", kArrayBuffer}},
      {{"buffer", 0}, {"byteOffset", corners_bytes}, {"byteLength", triangles_bytes}, {"target", kElementArrayBuffer}}};
  const size_t colors_bytes = BytesOf(surface.colors).size();
  if (colors_bytes > 0) {
    json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = 2;
    json["accessors"].push_back({{"bufferView", 2},
                                 {"componentType", kUnsignedByte},
                                 {"normalized", true},
                                 {"count", surface.colors.size()},
                                 {"type", "VEC4"}});
    json["bufferViews"].push_back({{"buffer", 0},
                                   {"byteOffset", corners_bytes + triangles_bytes},
                                   {"byteLength", colors_bytes},
                                   {"target", kArrayBuffer}});
  }
  json["buffers"] = {{{"byteLength", corners_bytes + triangles_bytes + colors_bytes}}};
  return json;
}

class GlbOutput final : public Output {
 public:
  explicit GlbOutput(std::unique_ptr<AtomicFile> file) : file_(std::move(file)) {}

  absl::Status Begin(const Accepted& accepted) override {
    grid_ = accepted.grid;
    return absl::OkStatus();
  }

  absl::Status Add(const BrickBatch& batch) override {
    bricks_.insert(bricks_.end(), batch.bricks.begin(), batch.bricks.end());
    if (const FieldValues* colors = FindField(batch.fields, Field::kColor)) {
      const size_t voxels = colors->bytes.size() / colors->bytes_of_voxel();
      for (size_t n = 0; n < voxels; ++n) colors_.push_back(NumberAt(*colors, n));
    }
    return absl::OkStatus();
  }

  absl::Status Finish(const Summary& summary) override {
    const Surface surface = SurfaceOf(bricks_, colors_, grid_);
    std::string json = Describe(surface, summary).dump();
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const uint64_t binary =
        BytesOf(surface.corners).size() + BytesOf(surface.triangles).size() + BytesOf(surface.colors).size();
    const uint64_t all = 12 + 8 + json.size() + (binary > 0 ? 8 + binary : 0);
    if (all > UINT32_MAX) {
      return absl::ResourceExhaustedError(absl::StrCat(file_->target(), ": the surface takes ", all,
                                                       " bytes, which exceeds the limit of ", UINT32_MAX,
                                                       " of a .glb"));
    }
    std::string head;
    AppendWords({kGlbMagic, kGlbVersion, static_cast<uint32_t>(all), static_cast<uint32_t>(json.size()), kJsonChunk},
                head);
    head += json;
    if (binary > 0) AppendWords({static_cast<uint32_t>(binary), kBinaryChunk}, head);
    for (const std::string_view part :
         {std::string_view(head), BytesOf(surface.corners), BytesOf(surface.triangles), BytesOf(surface.colors)}) {
      if (auto status = file_->Append(part); !status.ok()) return status;
    }
    return file_->Sync();
  }

  absl::Status Commit() override { return file_->Commit(); }

 private:
  std::unique_ptr<AtomicFile> file_;
  GridTransform grid_;
  std::vector<Brick> bricks_;
  std::vector<uint32_t> colors_;  // of their voxels, if these have some
};

}  // namespace

std::unique_ptr<Output> NewGlbOutput(std::unique_ptr<AtomicFile> file) {
  return std::make_unique<GlbOutput>(std::move(file));
}

}  // namespace latvox::client
