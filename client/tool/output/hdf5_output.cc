#include "client/tool/output/hdf5_output.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <optional>

#include "absl/strings/str_cat.h"
#include "client/grid/metadata_texts.h"
#include "client/internal/file_error.h"
#include "client/tool/hdf5/descriptor_driver.h"
#include "client/tool/hdf5/hdf5_attribute.h"
#include "client/tool/hdf5/hdf5_rows.h"
#include "client/tool/output/link_rows.h"
#include "latvox/for_each_voxel.h"

namespace latvox::client {
namespace {

// The root's own attributes tell the place.
bool IsOfPlace(const std::string& name) {
  return name == "latvox_basis" || name == "latvox_origin" || name == "latvox_voxel_size";
}

class Hdf5Output final : public Output {
 public:
  Hdf5Output(std::unique_ptr<AtomicFile> file, const VoxelizeRequest& request, const OutputOptions& options)
      : target_(std::move(file)), request_(request), note_(options.note), metadata_(options.metadata) {}
  ~Hdf5Output() override { Close(); }
  Hdf5Output(const Hdf5Output&) = delete;
  Hdf5Output& operator=(const Hdf5Output&) = delete;

  void SetNames(const CarriedNames& names) override { names_ = names; }

  absl::Status Begin(const Accepted& accepted) override {
    const auto library = Hdf5::Load();
    if (!library.ok()) {
      return absl::Status(library.status().code(), absl::StrCat(target_->target(), ": ", library.status().message()));
    }
    hdf5_ = *library;
    grid_ = accepted.grid;
    note_.facts = accepted.mesh;
    request_.placement = accepted.placement;  // the metadata state it, whatever a later version's default is
    fd_ = open(target_->temporary().c_str(), O_RDWR | O_CLOEXEC);
    if (fd_ < 0) error_ = errno;
    const Hdf5Id access = AccessBy(*hdf5_, {fd_, &error_});
    if (error_ == 0 && access.ok()) {
      constexpr unsigned kTruncate = 2;  // H5F_ACC_TRUNC, which would call the library
      file_ = {hdf5_->H5Fcreate("latvox", kTruncate, H5P_DEFAULT, access.get()), hdf5_->H5Fclose};
    }
    if (!file_.ok()) return Failed();
    MakeArrays(accepted);
    return absl::OkStatus();
  }

  absl::Status Add(const BrickBatch& batch) override {
    hdf5_->SilenceThread();
    const uint64_t first = ijk_->rows();
    for (const Brick& brick : batch.bricks) {
      if (auto status = target_->CheckGoesOn(); !status.ok()) return status;
      box_.Add(brick);
      brick_ijk_->Append(brick.brick_ijk);
      brick_mask_->Append(brick.mask);
      brick_first_->Append(ijk_->rows());
      ForEachVoxel(brick, [this](const Vec3i& ijk) { ijk_->Append(ijk); });
    }
    for (size_t n = 0; n < fields_.size(); ++n) {
      if (fields_[n]) fields_[n]->Append(batch.fields[n].bytes.data(), batch.fields[n].bytes.size());
    }
    if (link_voxel_) AddLinks(batch, first);
    return error_ == 0 ? absl::OkStatus() : Failed();
  }

  absl::Status Finish(const Summary& summary) override {
    hdf5_->SilenceThread();
    if (!note_.quantization) note_.quantization = static_cast<int>(summary.certificate.quantization_bits);
    bool good = WriteAttributes(summary);
    for (auto* const rows : {&ijk_, &brick_ijk_, &brick_mask_, &brick_first_, &link_ijk_, &link_voxel_, &link_neighbor_,
                             &link_share_, &link_triangle_, &link_crossings_}) {
      if (*rows) good = (*rows)->Finish() && good;
    }
    for (auto& rows : fields_) {
      if (rows) good = rows->Finish() && good;
    }
    Close();
    return good && error_ == 0 ? target_->Sync() : Failed();
  }

  absl::Status Commit() override { return target_->Commit(); }

 private:
  using Rows = std::optional<Hdf5Rows>;

  absl::Status Failed() const {
    const char* const why = error_ != 0 ? std::strerror(error_) : "HDF5 fails";
    const std::string& target = target_->target();
    return WithFile(absl::FailedPreconditionError(absl::StrCat(target, ": cannot be written (", why, ")")), "--out",
                    target);
  }

  // On any thread: that of the destructor may be another one than those of Begin and Finish.
  void Close() {
    if (hdf5_ != nullptr) hdf5_->SilenceThread();
    file_ = {};
    if (fd_ >= 0) close(fd_);
    fd_ = -1;
  }

  Hdf5Id Group(hid_t place, const char* name) const {
    return {hdf5_->H5Gcreate2(place, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), hdf5_->H5Gclose};
  }

  void MakeArrays(const Accepted& accepted) {
    const Hdf5Id sets = Group(file_.get(), "sets"), voxels = Group(sets.get(), "voxels");
    ijk_.emplace(*hdf5_, voxels.get(), Hdf5Form{"ijk", hdf5_->H5T_STD_I32LE_g, 4, 3});
    brick_ijk_.emplace(*hdf5_, voxels.get(), Hdf5Form{"brick_ijk", hdf5_->H5T_STD_I32LE_g, 4, 3});
    brick_mask_.emplace(*hdf5_, voxels.get(), Hdf5Form{"brick_mask", hdf5_->H5T_STD_U64LE_g, 8, 8});
    brick_first_.emplace(*hdf5_, voxels.get(), Hdf5Form{"brick_first", hdf5_->H5T_STD_U64LE_g, 8, 1});
    const Hdf5Id fields = Group(file_.get(), "fields");
    for (const Field field : request_.fields) {
      const FieldFacts& facts = FactsOf(field);
      Rows& rows = fields_.emplace_back();
      if (facts.is_of_links()) continue;
      const auto [type, bytes] = TypeOf(facts.type);
      rows.emplace(*hdf5_, fields.get(), Hdf5Form{facts.name, type, bytes, accepted.NoValues(field).components()});
    }
    if (CarriesLinks(request_.fields)) MakeLinks(accepted.neighbors);
  }

  void MakeLinks(const std::vector<Vec3i>& neighbors) {
    const Hdf5Id links = Group(file_.get(), "links");
    const auto make = [&](Rows& rows, const char* name, hid_t type, size_t bytes, size_t columns) {
      rows.emplace(*hdf5_, links.get(), Hdf5Form{name, type, bytes, columns});
    };
    const auto carries = [this](Field field) { return CarriesField(request_.fields, field); };
    Rows vectors;
    make(vectors, "neighbors", hdf5_->H5T_STD_I32LE_g, 4, 3);
    for (const Vec3i& q : neighbors) vectors->Append(q);
    vectors->Finish();
    make(link_voxel_, "voxel", hdf5_->H5T_STD_U64LE_g, 8, 1);
    make(link_neighbor_, "neighbor", hdf5_->H5T_STD_U8LE_g, 1, 1);
    make(link_ijk_, "ijk", hdf5_->H5T_STD_I32LE_g, 4, 3);
    if (carries(Field::kLinks)) make(link_share_, "share", hdf5_->H5T_IEEE_F32LE_g, 4, 1);
    if (carries(Field::kLinkTriangles)) make(link_triangle_, "triangle", hdf5_->H5T_STD_I32LE_g, 4, 1);
    if (carries(Field::kLinkCrossings)) make(link_crossings_, "crossings", hdf5_->H5T_STD_I32LE_g, 4, 1);
  }

  std::pair<hid_t, size_t> TypeOf(NumberType type) const {
    if (type == NumberType::kUint8) return {hdf5_->H5T_STD_U8LE_g, 1};
    if (type == NumberType::kUint16) return {hdf5_->H5T_STD_U16LE_g, 2};
    if (type == NumberType::kUint32) return {hdf5_->H5T_STD_I32LE_g, 4};
    return {hdf5_->H5T_IEEE_F32LE_g, 4};
  }

  void AddLinks(const BrickBatch& batch, uint64_t first) {
    ForEachCrossedLink(batch, [&](const LinkRow& row) {
      link_voxel_->Append(uint64_t{first + row.voxel});
      link_neighbor_->Append(static_cast<uint8_t>(row.neighbor));
      link_ijk_->Append(row.ijk);
      if (link_share_) link_share_->Append(row.share);
      if (link_triangle_) link_triangle_->Append(row.triangle);
      if (link_crossings_) link_crossings_->Append(row.crossings);
    });
  }

  bool WriteAttributes(const Summary& summary) const {
    const Hdf5Attributes root(*hdf5_, file_.get());
    const std::array steps = {grid_.basis.a, grid_.basis.b, grid_.basis.c};
    bool good = root.Write("format", std::string("latvox")) && root.Write("format_version", int32_t{1}) &&
                root.Write("lattice", summary.certificate.lattice) && root.Write("set", summary.certificate.set) &&
                root.Write("voxel_size", grid_.voxel_size) && root.Write("basis", steps) &&
                root.Write("origin", grid_.origin);
    if (const auto& box = box_.box()) good = good && root.Write("index_box", std::array{box->min, box->max});
    const auto texts = metadata_ ? *metadata_ : MetadataTexts(request_, note_, names_, summary);
    for (const auto& [name, text] : texts) {
      if (!IsOfPlace(name)) good = good && root.Write(name, text);
    }
    return good;
  }

  const std::unique_ptr<AtomicFile> target_;
  VoxelizeRequest request_;
  MeshNote note_;
  const std::optional<MetadataPairs> metadata_;
  CarriedNames names_;
  const Hdf5* hdf5_ = nullptr;
  int fd_ = -1, error_ = 0;
  GridTransform grid_;
  VoxelBox box_;
  Hdf5Id file_;
  Rows ijk_, brick_ijk_, brick_mask_, brick_first_;
  std::vector<Rows> fields_;  // none for fields of links
  Rows link_ijk_, link_voxel_, link_neighbor_, link_share_, link_triangle_, link_crossings_;
};

}  // namespace

std::unique_ptr<Output> NewHdf5Output(std::unique_ptr<AtomicFile> file, const VoxelizeRequest& request,
                                      const OutputOptions& options) {
  return std::make_unique<Hdf5Output>(std::move(file), request, options);
}

}  // namespace latvox::client
