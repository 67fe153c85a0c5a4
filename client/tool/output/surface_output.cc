#include "client/tool/output/surface_output.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/container/flat_hash_set.h"
#include "absl/strings/str_cat.h"
#include "client/json/json.h"
#include "client/mesh/srgb.h"
#include "client/tool/output/cell_index.h"
#include "client/tool/output/format_limit.h"
#include "client/tool/output/voronoi_cell.h"
#include "client/tool/output/voxel_colors.h"
#include "latvox/for_each_voxel.h"

namespace latvox::client {
namespace {

// Constants of glTF 2.0 and its binary container: "glTF", version, length, then chunks of length, type and bytes.
constexpr uint32_t kGlbMagic = 0x46546C67, kGlbVersion = 2, kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;
constexpr int kUnsignedShort = 5123, kFloat = 5126, kUnsignedInt = 5125, kArrayBuffer = 34962,
              kElementArrayBuffer = 34963;
static_assert(std::endian::native == std::endian::little);

using Position = std::array<float, 3>;
using Triangle = std::array<uint32_t, 3>;
using Rgba = std::array<uint16_t, 4>;  // linear, as glTF's vertices have it; 16 bits keep all bytes of sRGB apart

template <class T>
void AppendTo(std::string& out, const T& value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

void AppendWords(std::initializer_list<uint32_t> words, std::string& out) {
  for (const uint32_t word : words) AppendTo(out, word);
}

// Returns the linear color of red << 16 | green << 8 | blue in sRGB.
Rgba LinearOf(uint32_t color) {
  static const auto kOfBytes = [] {
    std::array<uint16_t, 256> linear;
    for (size_t n = 0; n < 256; ++n) {
      linear[n] = static_cast<uint16_t>(std::lround(ToLinear(static_cast<uint8_t>(n)) * UINT16_MAX));
    }
    return linear;
  }();
  return {kOfBytes[color >> 16 & 255], kOfBytes[color >> 8 & 255], kOfBytes[color & 255], UINT16_MAX};
}

// The triangles of the facets that have no voxel behind them. They are made again for each part of the file, so memory
// holds none of them: it holds the bricks, and 2 bytes for each voxel. Voxels do not share corners.
class Surface {
 public:
  // `bricks` must outlive the surface. It is incomplete once the call is cancelled.
  Surface(const std::vector<Brick>& bricks, const GridTransform& grid, const Cancellation& cancellation)
      : bricks_(bricks), grid_(grid), cell_(VoronoiCellOf(grid.basis)), patterns_(size_t{1} << cell_.faces.size()) {
    for (const Brick& brick : bricks) masks_[brick.brick_ijk] = brick.mask;
    if (!bricks.empty()) {
      const Vec3i& b = bricks[0].brick_ijk;
      place_ = grid.ToWorld({8 * b[0], 8 * b[1], 8 * b[2]});
    }
    for (const Brick& brick : bricks) {
      if (cancellation.cancelled()) return;
      ForEachVoxel(brick, [&](const Vec3i& ijk) {
        open_.push_back(OpenFacets(brick, ijk));
        const Pattern& pattern = PatternOf(open_.back());
        triangles_ += pattern.triangles.size();
        corners_ += pattern.corners.size();
        for (const Position& position : PositionsOf(pattern, ijk)) {
          for (size_t m = 0; m < 3; ++m) {
            low_[m] = std::min(low_[m], position[m]);
            high_[m] = std::max(high_[m], position[m]);
          }
        }
      });
    }
  }

  const Vec3d& place() const { return place_; }  // of position 0, in the world
  const Position& low() const { return low_; }
  const Position& high() const { return high_; }
  uint64_t corners() const { return corners_; }
  uint64_t triangles() const { return triangles_; }

  // Call append(bytes) with the bytes of one brick after the other, until it returns an error. `numbers` has one for
  // each voxel, whose color is ColorOfNumber.
  template <class Append>
  absl::Status AppendCorners(const Append& append) {
    return ForEachBrick(append, [this](const Vec3i& ijk, size_t, const Pattern& pattern, std::string& bytes) {
      const std::vector<Position>& positions = PositionsOf(pattern, ijk);
      bytes.append(reinterpret_cast<const char*>(positions.data()), positions.size() * sizeof(Position));
    });
  }
  template <class Append>
  absl::Status AppendTriangles(const Append& append) {
    uint32_t first = 0;
    return ForEachBrick(append, [&first](const Vec3i&, size_t, const Pattern& pattern, std::string& bytes) {
      for (const auto& [a, b, c] : pattern.triangles) AppendTo(bytes, Triangle{first + a, first + b, first + c});
      first += static_cast<uint32_t>(pattern.corners.size());
    });
  }
  template <class Append>
  absl::Status AppendColors(const std::vector<uint32_t>& numbers, ColorBy by, const Append& append) {
    return ForEachBrick(append, [&](const Vec3i&, size_t voxel, const Pattern& pattern, std::string& bytes) {
      const Rgba color = LinearOf(ColorOfNumber(by, numbers[voxel]));
      for (size_t corner = 0; corner < pattern.corners.size(); ++corner) AppendTo(bytes, color);
    });
  }

 private:
  // The surface of a voxel with certain open facets.
  struct Pattern {
    std::vector<Vec3d> corners;       // relative to the lattice point
    std::vector<Triangle> triangles;  // numbers in `corners`
  };

  // Returns a bit for each facet of the cell that has no voxel behind it.
  uint16_t OpenFacets(const Brick& brick, const Vec3i& ijk) const {
    uint16_t open = 0;
    for (size_t face = 0; face < cell_.faces.size(); ++face) {
      const Vec3i neighbor = Plus(ijk, cell_.faces[face].neighbor), brick_ijk = ShiftRight(neighbor, 3);
      const auto* mask = &brick.mask;
      if (brick_ijk != brick.brick_ijk) {
        const auto found = masks_.find(brick_ijk);
        mask = found == masks_.end() ? nullptr : &found->second;
      }
      if (mask == nullptr || !HasVoxel(*mask, neighbor)) open = static_cast<uint16_t>(open | 1U << face);
    }
    return open;
  }

  // Makes a pattern when a voxel first has it.
  const Pattern& PatternOf(uint16_t open) {
    std::optional<Pattern>& known = patterns_[open];
    if (known) return *known;
    Pattern& pattern = known.emplace();
    std::vector<int> numbers;  // of the corners, in the cell
    const auto corner = [&](int n) {
      const auto found = std::find(numbers.begin(), numbers.end(), n);
      const auto number = static_cast<uint32_t>(found - numbers.begin());
      if (found != numbers.end()) return number;
      numbers.push_back(n);
      pattern.corners.push_back(cell_.corners[static_cast<size_t>(n)]);
      return number;
    };
    for (size_t face = 0; face < cell_.faces.size(); ++face) {
      if ((open >> face & 1) == 0) continue;
      const std::vector<int>& corners = cell_.faces[face].corners;
      for (size_t n = 2; n < corners.size(); ++n) {
        pattern.triangles.push_back({corner(corners[0]), corner(corners[n - 1]), corner(corners[n])});
      }
    }
    return pattern;
  }

  // The result is valid until the next call.
  const std::vector<Position>& PositionsOf(const Pattern& pattern, const Vec3i& ijk) {
    const Vec3d center = grid_.ToWorld(ijk);
    positions_.resize(pattern.corners.size());
    for (size_t n = 0; n < positions_.size(); ++n) {
      for (size_t m = 0; m < 3; ++m) {
        positions_[n][m] = static_cast<float>(center[m] - place_[m] + pattern.corners[n][m]);
      }
    }
    return positions_;
  }

  // Calls make(ijk, number of the voxel, pattern, bytes) for each voxel, and append(bytes) for each brick.
  template <class Append, class Make>
  absl::Status ForEachBrick(const Append& append, const Make& make) {
    size_t voxel = 0;
    std::string bytes;
    for (const Brick& brick : bricks_) {
      bytes.clear();
      ForEachVoxel(brick, [&](const Vec3i& ijk) {
        make(ijk, voxel, PatternOf(open_[voxel]), bytes);
        ++voxel;
      });
      if (auto status = append(bytes); !status.ok()) return status;
    }
    return absl::OkStatus();
  }

  static constexpr float kMost = std::numeric_limits<float>::max();
  const std::vector<Brick>& bricks_;
  const GridTransform grid_;
  const VoronoiCell cell_;
  std::vector<std::optional<Pattern>> patterns_;  // by open facets; a cell has at most 14
  absl::flat_hash_map<Vec3i, decltype(Brick::mask)> masks_;
  std::vector<uint16_t> open_;  // facets of each voxel
  std::vector<Position> positions_;
  Vec3d place_{};
  Position low_{kMost, kMost, kMost}, high_{-kMost, -kMost, -kMost};
  uint64_t corners_ = 0, triangles_ = 0;
};

// Without voxels the scene is empty, because glTF does not allow empty meshes.
Json Describe(const Surface& surface, bool colored, const Summary& summary) {
  Json json = {{"asset", {{"version", "2.0"}, {"generator", "latvox " + summary.certificate.version}}},
               {"scene", 0},
               {"scenes", {Json::object()}}};
  json["extras"] = {{"voxels", summary.voxels},
                    {"lattice", summary.certificate.lattice},
                    {"separability", summary.certificate.separability},
                    {"digest", summary.certificate.digest}};
  if (surface.triangles() == 0) return json;
  const uint64_t corners_bytes = surface.corners() * sizeof(Position);
  const uint64_t triangles_bytes = surface.triangles() * sizeof(Triangle);
  const uint64_t colors_bytes = colored ? surface.corners() * sizeof(Rgba) : 0;
  json["scenes"][0]["nodes"] = {0};
  json["nodes"] = {{{"name", "voxels"}, {"mesh", 0}, {"translation", surface.place()}}};
  json["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"indices", 1}}}}}};
  json["accessors"] = {
      {{"bufferView", 0},
       {"componentType", kFloat},
       {"count", surface.corners()},
       {"type", "VEC3"},
       {"min", surface.low()},
       {"max", surface.high()}},
      {{"bufferView", 1}, {"componentType", kUnsignedInt}, {"count", 3 * surface.triangles()}, {"type", "SCALAR"}}};
  json["bufferViews"] = {
      {{"buffer", 0}, {"byteLength", corners_bytes}, {"target", kArrayBuffer}},
      {{"buffer", 0}, {"byteOffset", corners_bytes}, {"byteLength", triangles_bytes}, {"target", kElementArrayBuffer}}};
  if (colored) {
    json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = 2;
    json["accessors"].push_back({{"bufferView", 2},
                                 {"componentType", kUnsignedShort},
                                 {"normalized", true},
                                 {"count", surface.corners()},
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
  GlbOutput(std::unique_ptr<AtomicFile> file, const std::vector<Field>& fields)
      : file_(std::move(file)), color_by_(DefaultColorBy({fields})) {}

  absl::Status Begin(const Accepted& accepted) override {
    grid_ = accepted.grid;
    return absl::OkStatus();
  }

  absl::Status Add(const BrickBatch& batch) override {
    const auto numbers = NumbersOf(batch, color_by_);
    if (!numbers.ok()) return numbers.status();
    bricks_.insert(bricks_.end(), batch.bricks.begin(), batch.bricks.end());
    numbers_.insert(numbers_.end(), numbers->begin(), numbers->end());
    return absl::OkStatus();
  }

  std::vector<Warning> Warnings() const override {
    const absl::flat_hash_set<uint32_t> numbers(numbers_.begin(), numbers_.end());
    absl::flat_hash_set<uint32_t> colors;
    for (const uint32_t number : numbers) colors.insert(ColorOfNumber(color_by_, number));
    const auto merged = WarningOfMergedColors(file_->target(), color_by_, numbers.size(), colors.size());
    return merged ? std::vector{*merged} : std::vector<Warning>();
  }

  absl::Status Finish(const Summary& summary) override {
    Surface surface(bricks_, grid_, file_->cancellation());
    if (auto status = file_->CheckGoesOn(); !status.ok()) return status;
    const bool colored = !numbers_.empty();
    std::string json = Describe(surface, colored, summary).dump();
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const uint64_t binary =
        surface.corners() * (sizeof(Position) + (colored ? sizeof(Rgba) : 0)) + surface.triangles() * sizeof(Triangle);
    const uint64_t all = 12 + 8 + json.size() + (binary > 0 ? 8 + binary : 0);
    if (all > UINT32_MAX) {
      const std::string limit = absl::StrCat(UINT32_MAX);
      return TooLarge(file_->target(),
                      absl::StrCat("the surface takes ", all, " bytes, which exceed the format's ", limit),
                      absl::StrCat(all), limit);
    }
    std::string head;
    AppendWords({kGlbMagic, kGlbVersion, static_cast<uint32_t>(all), static_cast<uint32_t>(json.size()), kJsonChunk},
                head);
    head += json;
    if (binary > 0) AppendWords({static_cast<uint32_t>(binary), kBinaryChunk}, head);
    const auto append = [this](std::string_view bytes) { return file_->Append(bytes); };
    absl::Status status = append(head);
    if (status.ok()) status = surface.AppendCorners(append);
    if (status.ok()) status = surface.AppendTriangles(append);
    if (status.ok() && colored) status = surface.AppendColors(numbers_, color_by_, append);
    if (!status.ok()) return status;
    return file_->Sync();
  }

  absl::Status Commit() override { return file_->Commit(); }

 private:
  std::unique_ptr<AtomicFile> file_;
  const ColorBy color_by_;
  GridTransform grid_;
  std::vector<Brick> bricks_;
  std::vector<uint32_t> numbers_;  // of their voxels, if these have colors
};

}  // namespace

std::unique_ptr<Output> NewGlbOutput(std::unique_ptr<AtomicFile> file, const std::vector<Field>& fields) {
  return std::make_unique<GlbOutput>(std::move(file), fields);
}

}  // namespace latvox::client
