// Foreign files for `latvox info`. The first byte chooses the format. Every input gives facts or an error of the input.
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <string>

#include "client/tool/inspect/array_facts.h"
#include "client/tool/inspect/box_facts.h"
#include "client/tool/inspect/image_facts.h"
#include "client/tool/inspect/picture_facts.h"
#include "client/tool/inspect/table_facts.h"
#include "client/tool/inspect/vtk_facts.h"
#include "latvox/grid/voxel_grid.h"

namespace latvox::client {
namespace {

template <class Facts>
void Check(const absl::StatusOr<Facts>& facts) {
  if (!facts.ok() && facts.status().code() != absl::StatusCode::kInvalidArgument) std::abort();
}

template <auto of_file>
void CheckFile(const std::string& path) {
  const auto file = FileSource::Open(path);
  if (!file.ok()) std::abort();
  Check(of_file(**file));
}

template <auto of_path>
void CheckPath(const std::string& path) {
  Check(of_path(path));
}

// The elements may be in a file of another name.
void CheckMetaImage(const std::string& path) {
  const auto facts = MetaImageFacts(path);
  if (facts.status().code() != absl::StatusCode::kNotFound) Check(facts);
}

// ReadNanoFileInfo refuses a compressed grid: latvox reads it in a process without rights.
void CheckNano(const std::string& path) {
  const auto facts = ReadNanoFileInfo(path);
  if (facts.status().code() != absl::StatusCode::kFailedPrecondition) Check(facts);
}

// The order of formats is that of the corpus.
constexpr void (*kFormats[])(const std::string& path) = {
    CheckFile<NpyFacts>,     [](const std::string& path) { Check(NpzFacts(path)); },
    CheckFile<CsvFacts>,     CheckFile<PlyFacts>,
    CheckFile<BinvoxFacts>,  CheckFile<VoxFacts>,
    CheckFile<PngFacts>,     CheckFile<PageFacts>,
    CheckFile<SurfaceFacts>, CheckNano,
    CheckPath<NrrdFacts>,    CheckMetaImage,
    CheckPath<NiftiFacts>,   CheckFile<VtiFacts>,
    CheckFile<VtuFacts>,
};

}  // namespace
}  // namespace latvox::client

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size == 0) return 0;
  const int file = memfd_create("input", 0);
  if (file < 0 || write(file, data + 1, size - 1) != static_cast<ssize_t>(size - 1)) std::abort();
  latvox::client::kFormats[data[0] % std::size(latvox::client::kFormats)]("/proc/self/fd/" + std::to_string(file));
  close(file);
  return 0;
}
