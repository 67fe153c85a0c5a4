#include "client/grid/link_grids.h"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <set>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "client/grid/grid_reading.h"
#include "client/grid/openvdb_metadata.h"
#include "client/grid/tree_nodes.h"
#include "latvox/for_each_voxel.h"

namespace latvox::client {
namespace {

// The form of each field's grids: where the mesh does not cross a link, its voxel is not active. So files, and the one
// grid in memory, grow with the crossed links. Most voxels of a solid have none.
template <Field field>
struct LinkForm;

template <>
struct LinkForm<Field::kLinks> {
  using Number = float;
  using Grid = openvdb::FloatGrid;
  static constexpr float kBackground = 0;
  static constexpr float kUncrossed = std::numeric_limits<float>::quiet_NaN();
  static bool IsGood(float share) { return share > 0 && share <= 1; }
};

template <>
struct LinkForm<Field::kLinkTriangles> {
  using Number = int32_t;
  using Grid = openvdb::Int32Grid;
  static constexpr int32_t kBackground = -1, kUncrossed = -1;
  static bool IsGood(int32_t triangle) { return triangle >= 0; }
};

template <>
struct LinkForm<Field::kLinkCrossings> {
  using Number = int32_t;
  using Grid = openvdb::Int32Grid;
  static constexpr int32_t kBackground = 0, kUncrossed = 0;
  static bool IsGood(int32_t crossings) { return crossings > 0; }
};

// Calls visit(form) with the form of a field of links.
template <class Visit>
auto WithLinkForm(Field field, const Visit& visit) {
  if (field == Field::kLinks) return visit(LinkForm<Field::kLinks>());
  return field == Field::kLinkTriangles ? visit(LinkForm<Field::kLinkTriangles>())
                                        : visit(LinkForm<Field::kLinkCrossings>());
}

// Returns the grid of the n-th neighbor.
template <class Form>
openvdb::GridBase::Ptr NewLinkGrid(std::span<const Brick> bricks, const FieldValues& links, size_t n) {
  const auto grid = Form::Grid::create(Form::kBackground);
  const auto* const numbers = reinterpret_cast<const typename Form::Number*>(links.bytes.data());
  openvdb::tree::ValueAccessor<typename Form::Grid::TreeType> tree(grid->tree());
  for (const Brick& brick : bricks) {
    ForEachVoxel(brick, [&](const Vec3i& ijk) {
      if (IsCrossed(links, n)) tree.setValueOn({ijk[0], ijk[1], ijk[2]}, numbers[n]);
      n += links.neighbors;
    });
  }
  return grid;
}

// Adds the neighbor of a grid of the field. Ignores other names.
void AddNeighbor(Field field, const std::string& name, std::set<Vec3i>& neighbors) {
  const std::vector<std::string> words = absl::StrSplit(name, '_');
  Vec3i step{};
  if (words.size() < step.size()) return;
  for (size_t n = 0; n < step.size(); ++n) {
    if (!absl::SimpleAtoi(words[words.size() - step.size() + n], &step[n])) return;
  }
  if (name == LinkName(field, step)) neighbors.insert(step);
}

constexpr Field kLinkFields[] = {Field::kLinks, Field::kLinkTriangles, Field::kLinkCrossings};

template <class Form>
absl::Status ReadNeighborGrid(openvdb::GridBase& base, const std::string& path, const GridContent& content, size_t n,
                              FieldValues& links) {
  const auto wrong = [&](const auto&... what) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": the grid \"", base.getName(), "\" ", what...));
  };
  using Grid = typename Form::Grid;
  if (base.type() != Grid::gridType()) return wrong("is a ", base.type(), ", not a ", Grid::gridType());
  const auto leaves = SortedLeaves(static_cast<Grid&>(base).tree(), path);
  if (!leaves.ok()) return leaves.status();
  auto* numbers = reinterpret_cast<typename Form::Number*>(links.bytes.data()) + n;
  bool good = true, inside = true;
  auto leaf = leaves->begin();
  for (const Brick& brick : content.file.bricks) {
    if (leaf == leaves->end() || ToBrick(**leaf).brick_ijk != brick.brick_ijk) {
      numbers += CountVoxels(brick) * links.neighbors;
      continue;
    }
    const Brick crossed = ToBrick(**leaf);
    for (size_t word = 0; word < crossed.mask.size(); ++word) inside &= (crossed.mask[word] & ~brick.mask[word]) == 0;
    ForEachVoxel(brick, [&](const Vec3i& ijk) {
      const openvdb::Coord at(ijk[0], ijk[1], ijk[2]);
      if ((*leaf)->isValueOn(at)) good &= Form::IsGood(*numbers = (*leaf)->getValue(at));
      numbers += links.neighbors;
    });
    ++leaf;
  }
  if (leaf != leaves->end() || !inside) return wrong("has voxels that the grid \"", content.file.info.name, "\" lacks");
  return good ? absl::OkStatus() : wrong("has values that are no ", NameOf(links.field));
}

template <class Form>
absl::StatusOr<FieldValues> ReadLinkField(GridArchive& archive, const std::string& path, const GridContent& content,
                                          Field field) {
  const size_t neighbors = content.neighbors.size();
  FieldValues links{field, {}, neighbors};
  links.bytes.resize(content.file.info.active_voxels * links.bytes_of_voxel());
  auto* const numbers = reinterpret_cast<typename Form::Number*>(links.bytes.data());
  std::fill_n(numbers, content.file.info.active_voxels * neighbors, Form::kUncrossed);
  for (size_t n = 0; n < neighbors; ++n) {
    const auto grid = archive.ReadGrid(LinkName(field, content.neighbors[n]));
    if (auto status = ReadNeighborGrid<Form>(*grid, path, content, n, links); !status.ok()) return status;
  }
  return links;
}

// Lists of links take the crossings of one field for those of all.
absl::Status CheckSameLinks(const FieldValues& first, const FieldValues& links, const std::string& path) {
  const size_t all = first.bytes.size() / first.bytes_of_voxel() * first.neighbors;
  for (size_t n = 0; n < all; ++n) {
    if (IsCrossed(first, n) == IsCrossed(links, n)) continue;
    return absl::InvalidArgumentError(absl::StrCat(path, ": the grids of ", NameOf(links.field),
                                                   " have other voxels than those of ", NameOf(first.field)));
  }
  return absl::OkStatus();
}

}  // namespace

LateGrids LinkGrids(std::span<const Brick> bricks, std::span<const FieldValues> fields,
                    std::span<const Vec3i> neighbors, const openvdb::GridBase& like) {
  std::vector<const FieldValues*> of_links;
  for (const FieldValues& values : fields) {
    if (FactsOf(values.field).is_of_links()) of_links.push_back(&values);
  }
  return {of_links.size() * neighbors.size(), [=, &like](size_t n) {
            const FieldValues& links = *of_links[n / neighbors.size()];
            const size_t neighbor = n % neighbors.size();
            const openvdb::GridBase::Ptr grid = WithLinkForm(
                links.field, [&](auto form) { return NewLinkGrid<decltype(form)>(bricks, links, neighbor); });
            InsertMetadata(like, *grid);
            grid->setTransform(like.transform().copy());
            grid->setName(LinkName(links.field, neighbors[neighbor]));
            return grid;
          }};
}

absl::StatusOr<std::vector<Vec3i>> ReadNeighbors(const GridArchive& archive, const std::string& path) {
  std::set<Vec3i> neighbors;
  std::vector<Field> fields;
  for (const Field field : kLinkFields) {
    std::set<Vec3i> of_field;
    for (const std::string& name : archive.names()) AddNeighbor(field, name, of_field);
    if (!of_field.empty()) fields.push_back(field);
    neighbors.merge(of_field);
  }
  const auto wrong = [&path](const auto&... what) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": ", what...));
  };
  if (neighbors.contains(Vec3i{})) return wrong("has grids of a link with the step 0,0,0");
  std::set<Vec3i> both = neighbors;
  for (const Vec3i& q : neighbors) {
    // The least number has no opposite among those of 32 bits.
    Vec3i opposite{};
    std::ranges::transform(q, opposite.begin(), [](int32_t x) { return static_cast<int32_t>(-int64_t{x}); });
    both.insert(opposite);
  }
  if (both.size() > kMostNeighbors) {
    return wrong("has grids of links to ", both.size(), " neighbors, the limit is ", kMostNeighbors);
  }
  for (const Field field : fields) {
    for (const Vec3i& q : both) {
      if (!archive.HasGrid(LinkName(field, q))) return wrong("lacks the grid \"", LinkName(field, q), "\"");
    }
  }
  return std::vector<Vec3i>(both.begin(), both.end());
}

absl::Status ReadLinks(GridArchive& archive, const std::string& path, GridContent& content) {
  const FieldValues* first = nullptr;
  content.fields.reserve(content.fields.size() + std::size(kLinkFields));
  for (const Field field : kLinkFields) {
    if (content.neighbors.empty() || !archive.HasGrid(LinkName(field, content.neighbors.front()))) continue;
    auto links =
        WithLinkForm(field, [&](auto form) { return ReadLinkField<decltype(form)>(archive, path, content, field); });
    if (!links.ok()) return links.status();
    if (first != nullptr) {
      if (auto status = CheckSameLinks(*first, *links, path); !status.ok()) return status;
    }
    content.fields.push_back(*std::move(links));
    if (first == nullptr) first = &content.fields.back();
  }
  return absl::OkStatus();
}

}  // namespace latvox::client
