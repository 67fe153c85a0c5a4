#include "client/tool/output/vtk_output.h"

#include <algorithm>
#include <array>
#include <functional>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/tool/output/box_output.h"
#include "client/tool/output/dense_fields.h"
#include "client/tool/output/format_limit.h"
#include "client/tool/output/voronoi_cell.h"
#include "client/tool/output/vtk_file.h"
#include "latvox/for_each_voxel.h"

namespace latvox::client {
namespace {

std::string Numbers(const Vec3d& v) { return absl::StrFormat("%.17g %.17g %.17g", v[0], v[1], v[2]); }

class VtiOutput final : public Output {
 public:
  VtiOutput(std::unique_ptr<AtomicFile> file, const std::vector<Field>& fields, const BoxShape& shape)
      : file_(std::move(file)), fields_(fields, DenseOrder::kFirstFastest, shape, kOneElement) {}

  absl::Status Begin(const Accepted& accepted) override {
    if (!IsAlongAxes(accepted.grid.basis)) {
      return NoSuchCells(file_->target(), kBoxesOnly);
    }
    return fields_.Begin(accepted, file_->target());
  }

  absl::Status Add(const BrickBatch& batch) override { return fields_.Add(batch); }

  absl::Status Finish(const Summary&) override {
    if (auto status = fields_.Finish(); !status.ok()) return status;
    DenseBox& box = fields_.box();
    const Basis& basis = fields_.grid().basis;
    const Vec3d spacing = {basis.a[0], basis.b[1], basis.c[2]};
    Vec3d corner = fields_.corner();
    for (size_t m = 0; m < 3; ++m) corner[m] -= spacing[m] / 2;
    const auto [ni, nj, nk] = box.shape();
    const std::string extent = absl::StrCat("\"0 ", ni, " 0 ", nj, " 0 ", nk, "\"");
    VtkFile vtk = {
        "ImageData",
        absl::StrCat(" WholeExtent=", extent, " Origin=\"", Numbers(corner), "\" Spacing=\"", Numbers(spacing), "\""),
        absl::StrCat(" Extent=", extent),
        {{"CellData", {}}}};
    for (const DenseArray& array : fields_.Arrays()) {
      const auto rows = std::make_shared<DenseRows>(box, array.empty, array.put);
      vtk.sections[0].arrays.push_back({array.name, VtkTypeOf(array.type), array.components, array.bytes(box),
                                        [rows](std::string& chunk) { rows->Next(chunk); }});
    }
    if (auto status = WriteVtkFile(vtk, *file_); !status.ok()) return status;
    return file_->Sync();
  }

  absl::Status Commit() override { return file_->Commit(); }

 private:
  std::unique_ptr<AtomicFile> file_;
  DenseFields fields_;
};

// The numbers of VTK's types of cells.
enum class VtkCell : uint8_t { kVertex = 1, kHexahedron = 12, kPolyhedron = 42 };

// A cell around lattice point 0. Faces are of polyhedra alone.
struct Cell {
  VtkCell type;
  std::vector<Vec3d> corners;  // relative to the lattice point, in VTK's order
  std::vector<CellFace> faces;
};

// VTK draws hexahedra many times faster than polyhedra.
Cell CellOf(const Basis& basis) {
  if (!IsAlongAxes(basis)) {
    VoronoiCell cell = VoronoiCellOf(basis);
    return {VtkCell::kPolyhedron, std::move(cell.corners), std::move(cell.faces)};
  }
  Cell cell{VtkCell::kHexahedron, {}, {}};
  const double x = basis.a[0] / 2, y = basis.b[1] / 2;
  for (const double z : {-basis.c[2] / 2, basis.c[2] / 2}) {
    for (const auto& [u, v] : {std::pair(-x, -y), std::pair(x, -y), std::pair(x, y), std::pair(-x, y)}) {
      cell.corners.push_back({u, v, z});
    }
  }
  return cell;
}

class VtuOutput final : public Output {
 public:
  VtuOutput(std::unique_ptr<AtomicFile> file, const std::vector<Field>& fields, VtuForm form)
      : file_(std::move(file)), form_(form) {
    for (const Field field : fields) fields_.push_back({field, {}});
  }

  absl::Status Begin(const Accepted& accepted) override {
    grid_ = accepted.grid;
    for (FieldValues& values : fields_) values = accepted.NoValues(values.field);
    return absl::OkStatus();
  }

  absl::Status Add(const BrickBatch& batch) override {
    bricks_.insert(bricks_.end(), batch.bricks.begin(), batch.bricks.end());
    for (size_t n = 0; n < fields_.size(); ++n) {
      const std::vector<std::byte>& more = batch.fields[n].bytes;
      fields_[n].bytes.insert(fields_[n].bytes.end(), more.begin(), more.end());
    }
    return absl::OkStatus();
  }

  absl::Status Finish(const Summary&) override {
    voxels_ = 0;
    for (const Brick& brick : bricks_) voxels_ += CountVoxels(brick);
    std::vector<VtkArray> data = {ForEach<Vec3i>("ijk", "Int32", 3, [](const Vec3i& ijk, uint64_t) { return ijk; })};
    for (const FieldValues& values : fields_) {
      if (!FactsOf(values.field).is_of_labels()) data.push_back(Values(values));
      for (size_t label = 0; label < values.labels.size(); ++label) data.push_back(Fractions(values, label));
    }
    const VtkFile vtk = form_ == VtuForm::kPoints ? AsPoints(std::move(data)) : AsCells(std::move(data));
    if (auto status = WriteVtkFile(vtk, *file_); !status.ok()) return status;
    return file_->Sync();
  }

  absl::Status Commit() override { return file_->Commit(); }

 private:
  VtkFile AsPoints(std::vector<VtkArray> data) const {
    const auto position = [this](const Vec3i& ijk, uint64_t) { return grid_.ToWorld(ijk); };
    const auto number = [](const Vec3i&, uint64_t n) { return n; };
    const auto next = [](const Vec3i&, uint64_t n) { return n + 1; };
    const auto vertex = [](const Vec3i&, uint64_t) { return VtkCell::kVertex; };
    return {"UnstructuredGrid",
            "",
            absl::StrCat(" NumberOfPoints=\"", voxels_, "\" NumberOfCells=\"", voxels_, "\""),
            {{"PointData", std::move(data)},
             {"Points", {ForEach<Vec3d>("Points", "Float64", 3, position)}},
             {"Cells",
              {ForEach<uint64_t>("connectivity", "Int64", 1, number), ForEach<uint64_t>("offsets", "Int64", 1, next),
               ForEach<VtkCell>("types", "UInt8", 1, vertex)}}}};
  }

  // Cells share no points, so that each can be written without the others.
  VtkFile AsCells(std::vector<VtkArray> data) const {
    const auto cell = std::make_shared<const Cell>(CellOf(grid_.basis));
    const uint64_t corners = cell->corners.size();
    const auto append_corners = [this, cell](const Vec3i& ijk, uint64_t, std::vector<double>& to) {
      const Vec3d center = grid_.ToWorld(ijk);
      for (const Vec3d& corner : cell->corners) {
        for (size_t m = 0; m < 3; ++m) to.push_back(center[m] + corner[m]);
      }
    };
    const auto append_numbers = [corners](const Vec3i&, uint64_t n, std::vector<uint64_t>& to) {
      for (uint64_t corner = 0; corner < corners; ++corner) to.push_back(n * corners + corner);
    };
    const auto next = [corners](const Vec3i&, uint64_t n) { return (n + 1) * corners; };
    const auto type = [cell](const Vec3i&, uint64_t) { return cell->type; };
    std::vector<VtkArray> cells = {ForEachRow<uint64_t>("connectivity", "Int64", 1, corners, append_numbers),
                                   ForEach<uint64_t>("offsets", "Int64", 1, next),
                                   ForEach<VtkCell>("types", "UInt8", 1, type)};
    if (cell->type == VtkCell::kPolyhedron) AddFaces(cell, cells);
    return {"UnstructuredGrid",
            "",
            absl::StrCat(" NumberOfPoints=\"", voxels_ * corners, "\" NumberOfCells=\"", voxels_, "\""),
            {{"CellData", std::move(data)},
             {"Points", {ForEachRow<double>("Points", "Float64", 3, 3 * corners, append_corners)}},
             {"Cells", std::move(cells)}}};
  }

  // For each cell: the number of its faces, and for each face the number of its corners and the corners.
  void AddFaces(const std::shared_ptr<const Cell>& cell, std::vector<VtkArray>& cells) const {
    uint64_t numbers = 1;
    for (const CellFace& face : cell->faces) numbers += 1 + face.corners.size();
    const auto append_faces = [cell](const Vec3i&, uint64_t n, std::vector<uint64_t>& to) {
      to.push_back(cell->faces.size());
      for (const CellFace& face : cell->faces) {
        to.push_back(face.corners.size());
        for (const int corner : face.corners) to.push_back(n * cell->corners.size() + static_cast<uint64_t>(corner));
      }
    };
    cells.push_back(ForEachRow<uint64_t>("faces", "Int64", 1, numbers, append_faces));
    const auto next = [numbers](const Vec3i&, uint64_t n) { return (n + 1) * numbers; };
    cells.push_back(ForEach<uint64_t>("faceoffsets", "Int64", 1, next));
  }

  // Returns an array to which append(ijk, n, to) appends `count` numbers for each voxel.
  template <class T, class Append>
  VtkArray ForEachRow(const std::string& name, const std::string& type, size_t components, uint64_t count,
                      const Append& append) const {
    const auto next = [this, append, brick = size_t{0}, n = uint64_t{0}](std::string& chunk) mutable {
      constexpr size_t kBricks = 256;
      std::vector<T> numbers;
      for (const size_t end = std::min(bricks_.size(), brick + kBricks); brick < end; ++brick) {
        ForEachVoxel(bricks_[brick], [&](const Vec3i& ijk) { append(ijk, n++, numbers); });
      }
      chunk.assign(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(T));
    };
    return {name, type, components, voxels_ * count * sizeof(T), next};
  }

  // Returns an array with value(ijk, n) for each voxel.
  template <class T, class Value>
  VtkArray ForEach(const std::string& name, const std::string& type, size_t components, const Value& value) const {
    const auto append = [value](const Vec3i& ijk, uint64_t n, std::vector<T>& to) { to.push_back(value(ijk, n)); };
    return ForEachRow<T>(name, type, components, 1, append);
  }

  static VtkArray Values(const FieldValues& values) {
    const auto next = [&values, done = size_t{0}](std::string& chunk) mutable {
      const size_t now = std::min(size_t{1} << 20, values.bytes.size() - done);
      chunk.assign(reinterpret_cast<const char*>(values.bytes.data()) + done, now);
      done += now;
    };
    return {NameOf(values.field), VtkTypeOf(FactsOf(values.field).type), values.components(), values.bytes.size(),
            next};
  }

  VtkArray Fractions(const FieldValues& values, size_t label) const {
    const auto fraction = [all = values.As<uint16_t>(), labels = values.labels.size(), label](
                              const Vec3i&, uint64_t n) { return all[n * labels + label]; };
    return ForEach<uint16_t>(FractionName(values.labels[label]), "UInt16", 1, fraction);
  }

  std::unique_ptr<AtomicFile> file_;
  const VtuForm form_;
  GridTransform grid_;
  std::vector<Brick> bricks_;
  std::vector<FieldValues> fields_;
  uint64_t voxels_ = 0;
};

}  // namespace

std::unique_ptr<Output> NewVtiOutput(std::unique_ptr<AtomicFile> file, const std::vector<Field>& fields,
                                     const BoxShape& shape) {
  return std::make_unique<VtiOutput>(std::move(file), fields, shape);
}

std::unique_ptr<Output> NewVtuOutput(std::unique_ptr<AtomicFile> file, const std::vector<Field>& fields, VtuForm form) {
  return std::make_unique<VtuOutput>(std::move(file), fields, form);
}

}  // namespace latvox::client
