#include "client/tool/output/page_output.h"

#include <filesystem>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/tool/vdb/vdb.h"
#include "latvox/error.h"
#include "latvox/grid/grid_content.h"

namespace latvox::client {
namespace {

class PageOutput final : public Output {
 public:
  PageOutput(std::unique_ptr<AtomicFile> file, const OutputOptions& options, NewVdb new_vdb)
      : file_(std::move(file)), up_(options.picture_up), make_page_(options.make_page), new_vdb_(std::move(new_vdb)) {}

  void SetNames(const CarriedNames& names) override { names_ = names; }

  absl::Status Begin(const Accepted& accepted) override {
    auto grid = AtomicFile::Create(file_->target(), AtomicFile::Form::kUnnamed, file_->cancellation());
    if (!grid.ok()) return grid.status();
    grid_path_ = (*grid)->temporary();
    grid_ = new_vdb_(*std::move(grid));
    grid_->SetNames(names_);
    return grid_->Begin(accepted);
  }

  absl::Status Add(const BrickBatch& batch) override { return grid_->Add(batch); }

  absl::Status Finish(const Summary& summary) override {
    if (auto status = grid_->Finish(summary); !status.ok()) return status;
    const auto vdb = Vdb::Load();
    if (!vdb.ok()) return vdb.status();
    const auto content = (*vdb)->ReadOwnContent(grid_path_);
    grid_.reset();
    if (!content.ok()) return content.status();
    if (auto status = file_->CheckGoesOn(); !status.ok()) return status;
    const auto page = make_page_(*content, std::filesystem::path(file_->target()).stem().string(), up_);
    if (!page.ok()) {
      absl::Status named(page.status().code(), absl::StrCat(file_->target(), ": ", page.status().message()));
      SetErrorDetails(GetErrorDetails(page.status()), named);
      return named;
    }
    if (auto status = file_->Append(*page); !status.ok()) return status;
    return file_->Sync();
  }

  absl::Status Commit() override { return file_->Commit(); }

 private:
  std::unique_ptr<AtomicFile> file_;
  const UpAxis up_;
  const MakePage make_page_;
  const NewVdb new_vdb_;
  CarriedNames names_;
  std::string grid_path_;
  std::unique_ptr<Output> grid_;
};

}  // namespace

std::unique_ptr<Output> NewPageOutput(std::unique_ptr<AtomicFile> file, const OutputOptions& options, NewVdb new_vdb) {
  return std::make_unique<PageOutput>(std::move(file), options, std::move(new_vdb));
}

}  // namespace latvox::client
