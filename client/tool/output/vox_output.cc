#include "client/tool/output/vox_output.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "absl/container/btree_set.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/string_view.h"
#include "client/tool/output/box_output.h"
#include "client/tool/output/format_limit.h"
#include "client/tool/output/palette.h"
#include "client/tool/output/voxel_colors.h"
#include "latvox/for_each_voxel.h"

namespace latvox::client {
namespace {

constexpr int64_t kMostSide = 256;     // of a model
constexpr size_t kMostColors = 255;    // of a palette; number 0 is no voxel
constexpr uint8_t kDefaultNumber = 1;  // in the palette of the program
constexpr uint64_t kMostBytes = std::numeric_limits<uint32_t>::max();

std::string Word(uint64_t word) {
  std::string bytes;
  for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<char>(word >> shift & 0xFF));
  return bytes;
}

std::string Words(std::initializer_list<uint64_t> words) {
  std::string bytes;
  for (const uint64_t word : words) bytes += Word(word);
  return bytes;
}

std::string Text(absl::string_view text) { return absl::StrCat(Word(text.size()), text); }

// A chunk has an id, the bytes of its content, and those of its subchunks.
std::string ChunkHead(absl::string_view id, uint64_t bytes, uint64_t bytes_of_subchunks = 0) {
  return absl::StrCat(id, Words({bytes, bytes_of_subchunks}));
}

std::string Chunk(absl::string_view id, absl::string_view content) {
  return absl::StrCat(ChunkHead(id, content.size()), content);
}

// The nodes of a scene: a root, its group, and two for each model.
class Scene {
 public:
  explicit Scene(size_t models) {
    std::string group = Words({kGroup, 0, models});
    for (size_t model = 0; model < models; ++model) group += Word(NodeOf(model));
    chunks_ = Transform(kRoot, kGroup, {}) + Chunk("nGRP", group);
  }

  // Adds the next model, with its middle at this place.
  void Add(const Vec3i& middle) {
    const uint32_t node = NodeOf(models_);
    const std::string place = absl::StrCat(Text("_t"), Text(absl::StrJoin(middle, " ")));
    chunks_ += Transform(node, node + 1, place) + Chunk("nSHP", Words({node + 1, 0, 1, models_, 0}));
    ++models_;
  }

  const std::string& chunks() const { return chunks_; }

 private:
  static constexpr uint32_t kRoot = 0, kGroup = 1, kNone = ~0U;

  static uint32_t NodeOf(size_t model) { return static_cast<uint32_t>(2 + 2 * model); }

  // A node without attributes; `place` is an attribute of its only frame.
  static std::string Transform(uint32_t node, uint32_t child, const std::string& place) {
    const uint32_t layer = node == kRoot ? kNone : 0;
    return Chunk("nTRN", absl::StrCat(Words({node, 0, child, kNone, layer, 1, place.empty() ? 0U : 1U}), place));
  }

  uint32_t models_ = 0;
  std::string chunks_;
};

// Returns a palette whose number_of takes numbers of NumbersOf. Parts and materials have an entry each, so that equal
// colors keep them apart. Too many of them have an entry for each color.
Palette PaletteOfNumbers(std::span<const uint32_t> numbers, ColorBy by) {
  if (by == ColorBy::kColor) return PaletteOf(numbers, kMostColors);
  const absl::btree_set<uint32_t> labels(numbers.begin(), numbers.end());
  std::vector<uint32_t> colors;
  for (const uint32_t label : labels) colors.push_back(ColorOfNumber(by, label));
  const bool has_room = labels.size() <= kMostColors;
  const Palette by_color = PaletteOf(colors, kMostColors);
  Palette palette;
  palette.colors = has_room ? colors : by_color.colors;
  uint32_t entry = 0;
  for (const uint32_t label : labels) {
    palette.number_of[label] = has_room ? entry : by_color.number_of.at(colors[entry]);
    ++entry;
  }
  return palette;
}

// Collects all bricks, then writes "VOX ", the version, and a chunk MAIN of all others.
class VoxOutput final : public Output {
 public:
  VoxOutput(std::unique_ptr<AtomicFile> file, const std::vector<Field>& fields)
      : file_(std::move(file)), color_by_(DefaultColorBy({fields})) {}

  absl::Status Begin(const Accepted& accepted) override {
    if (IsCubic(accepted.grid.basis)) return absl::OkStatus();
    return NoSuchCells(file_->target(), kCubesOnly);
  }

  absl::Status Add(const BrickBatch& batch) override {
    const auto numbers = NumbersOf(batch, color_by_);
    if (!numbers.ok()) return numbers.status();
    size_t voxel = numbers_.size();
    numbers_.insert(numbers_.end(), numbers->begin(), numbers->end());
    for (const Brick& brick : batch.bricks) {
      box_.Add(brick);
      bricks_.push_back({brick, voxel});
      voxel += CountVoxels(brick);
    }
    return absl::OkStatus();
  }

  std::vector<Warning> Warnings() const override {
    const Palette& palette = WholePalette();
    const auto merged =
        WarningOfMergedColors(file_->target(), color_by_, palette.number_of.size(), palette.colors.size());
    return merged ? std::vector{*merged} : std::vector<Warning>();
  }

  absl::Status Finish(const Summary&) override {
    if (auto status = Write(); !status.ok()) return status;
    return file_->Sync();
  }

  absl::Status Commit() override { return file_->Commit(); }

 private:
  struct ColoredBrick {
    Brick brick;
    size_t first;  // of its voxels
  };
  struct Model {
    std::vector<ColoredBrick> bricks;
    VoxelBox box;
    uint64_t voxels = 0;
  };

  // Models begin at bricks, so that no brick is in two of them. A box that fits one model stays whole.
  std::array<int64_t, 3> ModelOf(const Brick& brick) const {
    std::array<int64_t, 3> model{};
    for (size_t m = 0; m < 3; ++m) {
      const int64_t low = box_.box()->min[m], side = box_.box()->max[m] - low;
      if (side > kMostSide) model[m] = (int64_t{8} * brick.brick_ijk[m] - (low & ~int64_t{7})) / kMostSide;
    }
    return model;
  }

  std::vector<Model> TakeModels() {
    std::ranges::stable_sort(bricks_, {}, [this](const ColoredBrick& one) { return ModelOf(one.brick); });
    std::vector<Model> models;
    for (const ColoredBrick& one : bricks_) {
      if (models.empty() || ModelOf(models.back().bricks.back().brick) != ModelOf(one.brick)) models.emplace_back();
      Model& model = models.back();
      model.bricks.push_back(one);
      model.box.Add(one.brick);
      model.voxels += CountVoxels(one.brick);
    }
    bricks_ = {};
    if (models.empty()) models.emplace_back();  // readers expect one
    return models;
  }

  // Returns one point if there are no voxels.
  static IndexBox BoxOf(const VoxelBox& box) { return box.box().value_or(IndexBox{{0, 0, 0}, {1, 1, 1}}); }

  // Returns the lattice point of a model's middle as MagicaVoxel counts it, relative to that of the scene.
  Vec3i MiddleOf(const IndexBox& box) const {
    const IndexBox all = BoxOf(box_);
    Vec3i middle{};
    for (size_t m = 0; m < 3; ++m) {
      const int64_t origin = m == 2 ? int64_t{all.min[2]} : (int64_t{all.min[m]} + all.max[m]) >> 1;
      middle[m] = static_cast<int32_t>(box.min[m] - origin + (int64_t{box.max[m]} - box.min[m]) / 2);
    }
    return middle;
  }

  // Once all voxels have come. The warnings and the file need the same one.
  const Palette& WholePalette() const {
    if (!palette_) palette_ = PaletteOfNumbers(numbers_, color_by_);
    return *palette_;
  }

  static std::string SizeOf(const IndexBox& box) {
    std::string size;
    for (size_t m = 0; m < 3; ++m) size += Word(static_cast<uint64_t>(int64_t{box.max[m]} - box.min[m]));
    return Chunk("SIZE", size);
  }

  std::string VoxelsOf(const Model& model, const Palette& palette) const {
    std::string chunk = ChunkHead("XYZI", 4 + 4 * model.voxels) + Word(model.voxels);
    const Vec3i low = BoxOf(model.box).min;
    for (const auto& [brick, first] : model.bricks) {
      size_t voxel = first;
      ForEachVoxel(brick, [&](const Vec3i& ijk) {
        for (size_t m = 0; m < 3; ++m) chunk.push_back(static_cast<char>(ijk[m] - low[m]));
        const uint32_t number = numbers_.empty() ? kDefaultNumber : 1 + palette.number_of.at(numbers_[voxel++]);
        chunk.push_back(static_cast<char>(number));
      });
    }
    return chunk;
  }

  // Color number n is entry n - 1.
  static std::string ChunkOf(const Palette& palette) {
    if (palette.colors.empty()) return {};
    std::string rgba;
    for (const uint32_t color : palette.colors) {
      for (const int shift : {16, 8, 0}) rgba.push_back(static_cast<char>(color >> shift & 0xFF));
      rgba.push_back('\xFF');
    }
    rgba.resize(4 * (kMostColors + 1));
    return Chunk("RGBA", rgba);
  }

  absl::Status Write() {
    const std::vector<Model> models = TakeModels();
    const Palette& palette = WholePalette();
    Scene scene(models.size());
    uint64_t voxels = 0;
    for (const Model& model : models) {
      scene.Add(MiddleOf(BoxOf(model.box)));
      voxels += model.voxels;
    }
    const std::string end = absl::StrCat(models.size() > 1 ? scene.chunks() : "", ChunkOf(palette));
    constexpr uint64_t kBytesOfModel = 24 + 16;  // SIZE; XYZI without its voxels
    const uint64_t bytes = models.size() * kBytesOfModel + 4 * voxels + end.size();
    if (bytes > kMostBytes) {
      const std::string limit = absl::StrCat(kMostBytes);
      return TooLarge(file_->target(),
                      absl::StrCat(voxels, " voxels make ", bytes, " bytes, which exceed the format's ", limit),
                      absl::StrCat(bytes), limit);
    }
    const auto append = [this](const std::string& chunk) { return file_->Append(chunk); };
    if (auto status = append("VOX " + Word(150) + ChunkHead("MAIN", 0, bytes)); !status.ok()) return status;
    for (const Model& model : models) {
      if (auto status = append(SizeOf(BoxOf(model.box))); !status.ok()) return status;
      if (auto status = append(VoxelsOf(model, palette)); !status.ok()) return status;
    }
    return append(end);
  }

  const std::unique_ptr<AtomicFile> file_;
  const ColorBy color_by_;
  VoxelBox box_;
  std::vector<ColoredBrick> bricks_;
  std::vector<uint32_t> numbers_;  // of all voxels, in the order of the stream; empty: no colors
  mutable std::optional<Palette> palette_;
};

}  // namespace

std::unique_ptr<Output> NewVoxOutput(std::unique_ptr<AtomicFile> file, const std::vector<Field>& fields) {
  return std::make_unique<VoxOutput>(std::move(file), fields);
}

}  // namespace latvox::client
