#include "client/tool/output/link_output.h"

#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/tool/output/link_rows.h"
#include "client/tool/output/npy_header.h"
#include "client/tool/output/npz_member.h"
#include "client/tool/output/zip_writer.h"

namespace latvox::client {
namespace {

// The facts about the call that both formats need.
class LinkOutput : public Output {
 public:
  LinkOutput(std::unique_ptr<AtomicFile> file, const std::vector<Field>& fields)
      : has_shares_(CarriesField(fields, Field::kLinks)),
        has_triangles_(CarriesField(fields, Field::kLinkTriangles)),
        has_crossings_(CarriesField(fields, Field::kLinkCrossings)),
        file_(std::move(file)) {}

  absl::Status Begin(const Accepted& accepted) override {
    grid_ = accepted.grid;
    neighbors_ = accepted.neighbors;
    GridTransform at_zero = grid_;
    at_zero.origin = {};
    for (const Vec3i& q : neighbors_) {
      const Vec3d step = at_zero.ToWorld(q);
      lengths_.push_back(std::hypot(step[0], step[1], step[2]));
    }
    return absl::OkStatus();
  }

  absl::Status Commit() final { return file_->Commit(); }

 protected:
  const bool has_shares_, has_triangles_, has_crossings_;
  const std::unique_ptr<AtomicFile> file_;
  GridTransform grid_;
  std::vector<Vec3i> neighbors_;
  std::vector<double> lengths_;  // of the vectors to neighbors, in the world
};

class LinkTableOutput final : public LinkOutput {
 public:
  using LinkOutput::LinkOutput;

  absl::Status Begin(const Accepted& accepted) override {
    if (auto status = LinkOutput::Begin(accepted); !status.ok()) return status;
    return file_->Append(absl::StrCat("i,j,k,di,dj,dk", has_shares_ ? ",share,distance" : "",
                                      has_triangles_ ? ",triangle" : "", has_crossings_ ? ",crossings" : "", "\n"));
  }

  absl::Status Add(const BrickBatch& batch) override {
    absl::Status status;
    ForEachCrossedLink(batch, [&](const LinkRow& row) {
      const auto [i, j, k] = row.ijk;
      const auto [di, dj, dk] = neighbors_[row.neighbor];
      rows_.clear();
      absl::StrAppend(&rows_, i, ",", j, ",", k, ",", di, ",", dj, ",", dk);
      if (has_shares_) {
        absl::StrAppendFormat(&rows_, ",%.9g,%.9g", row.share, double{row.share} * lengths_[row.neighbor]);
      }
      if (has_triangles_) absl::StrAppend(&rows_, ",", row.triangle);
      if (has_crossings_) absl::StrAppend(&rows_, ",", row.crossings);
      rows_ += '\n';
      if (status.ok()) status = file_->Append(rows_);
    });
    return status;
  }

  absl::Status Finish(const Summary&) override { return file_->Sync(); }

 private:
  std::string rows_;
};

class LinkArrayOutput final : public LinkOutput {
 public:
  using LinkOutput::LinkOutput;

  absl::Status Add(const BrickBatch& batch) override {
    ForEachCrossedLink(batch, [this](const LinkRow& row) {
      ijk_.push_back(row.ijk);
      neighbor_.push_back(static_cast<uint8_t>(row.neighbor));
      if (has_shares_) share_.push_back(row.share);
      if (has_triangles_) triangle_.push_back(row.triangle);
      if (has_crossings_) crossings_.push_back(row.crossings);
    });
    return absl::OkStatus();
  }

  absl::Status Finish(const Summary&) override {
    std::vector<ZipMember> members = {Array("ijk", "'<i4'", ijk_, 3), Array("neighbor", "'|u1'", neighbor_),
                                      Array("neighbors", "'<i4'", neighbors_, 3), Array("lengths", "'<f8'", lengths_)};
    if (has_shares_) members.push_back(Array("share", "'<f4'", share_));
    if (has_triangles_) members.push_back(Array("triangle", "'<i4'", triangle_));
    if (has_crossings_) members.push_back(Array("crossings", "'<i4'", crossings_));
    const std::vector<Vec3d> steps = {grid_.basis.a, grid_.basis.b, grid_.basis.c};
    const std::vector<double> origin(grid_.origin.begin(), grid_.origin.end());
    members.push_back(Array("basis", "'<f8'", steps, 3));
    members.push_back(Array("origin", "'<f8'", origin));
    if (auto status = WriteZip(members, *file_); !status.ok()) return status;
    return file_->Sync();
  }

 private:
  template <class T>
  static ZipMember Array(const std::string& name, const char* type, const std::vector<T>& rows, uint64_t columns = 1) {
    std::vector<uint64_t> shape = {rows.size()};
    if (columns > 1) shape.push_back(columns);
    return RowsMember(name, NpyHeader(type, shape), rows);
  }

  std::vector<Vec3i> ijk_;
  std::vector<uint8_t> neighbor_;
  std::vector<float> share_;
  std::vector<int32_t> triangle_, crossings_;
};

}  // namespace

std::unique_ptr<Output> NewLinkTableOutput(std::unique_ptr<AtomicFile> file, const std::vector<Field>& fields) {
  return std::make_unique<LinkTableOutput>(std::move(file), fields);
}

std::unique_ptr<Output> NewLinkArrayOutput(std::unique_ptr<AtomicFile> file, const std::vector<Field>& fields) {
  return std::make_unique<LinkArrayOutput>(std::move(file), fields);
}

}  // namespace latvox::client
