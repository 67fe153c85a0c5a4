#include "client/tool/output/output.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/tool/output/atomic_file.h"
#include "client/tool/output/box_output.h"
#include "client/tool/output/dense_output.h"
#include "client/tool/output/hdf5_output.h"
#include "client/tool/output/image_output.h"
#include "client/tool/output/link_output.h"
#include "client/tool/output/npz_output.h"
#include "client/tool/output/page_output.h"
#include "client/tool/output/picture_output.h"
#include "client/tool/output/surface_output.h"
#include "client/tool/output/table_output.h"
#include "client/tool/output/vox_output.h"
#include "client/tool/output/voxel_colors.h"
#include "client/tool/output/vtk_output.h"
#include "client/tool/vdb/brick_grid.h"
#include "client/tool/vdb/vdb.h"
#include "latvox/error.h"

namespace latvox::client {
namespace {

// A set of voxels alone is written without OpenVDB.
bool NeedsOpenVdb(VdbFormat format, const std::vector<Field>& fields) {
  return format != VdbFormat::kOpenVdb || !fields.empty();
}

class GridOutput final : public Output {
 public:
  using NewGrid = std::function<Vdb::NewGrid(const Vdb*, const Accepted&)>;  // null if NeedsOpenVdb is false

  GridOutput(std::unique_ptr<AtomicFile> file, VdbFormat format, const VoxelizeRequest& request,
             const OutputOptions& options, NewGrid new_grid)
      : file_(std::move(file)),
        format_(format),
        request_(request),
        note_(options.note),
        metadata_(options.metadata),
        new_grid_(std::move(new_grid)) {}

  void SetNames(const CarriedNames& names) override { names_ = names; }
  absl::Status Begin(const Accepted& accepted) override {
    const Vdb* loaded = nullptr;
    if (NeedsOpenVdb(format_, request_.fields)) {
      const auto vdb = Vdb::Load();
      if (!vdb.ok()) return vdb.status();
      loaded = *vdb;
    }
    auto grid = new_grid_(loaded, accepted);
    if (!grid.ok()) return Named(grid.status());
    grid_ = *std::move(grid);
    note_.facts = accepted.mesh;
    request_.placement = accepted.placement;  // the metadata state it, whatever a later version's default is
    return absl::OkStatus();
  }
  absl::Status Add(const BrickBatch& batch) override { return grid_->Add(batch); }
  absl::Status Finish(const Summary& summary) override {
    if (!note_.quantization) note_.quantization = static_cast<int>(summary.certificate.quantization_bits);
    if (metadata_) {
      grid_->SetMetadata(*metadata_);
    } else {
      grid_->Describe(request_, note_, names_, summary);
    }
    const absl::Status written = grid_->Write(file_->temporary(), format_, file_->cancellation());
    if (!written.ok()) return file_->Named(written);
    return file_->Sync();
  }
  absl::Status Commit() override { return file_->Commit(); }

 private:
  // Returns the error with the target before it.
  absl::Status Named(const absl::Status& status) const {
    absl::Status named(status.code(), absl::StrCat(file_->target(), ": ", status.message()));
    SetErrorDetails(GetErrorDetails(status), named);
    return named;
  }

  std::unique_ptr<AtomicFile> file_;
  const VdbFormat format_;
  VoxelizeRequest request_;
  MeshNote note_;
  const std::optional<MetadataPairs> metadata_;
  const NewGrid new_grid_;
  CarriedNames names_;
  std::unique_ptr<VdbGrid> grid_;
};

// Returns what makes the grid of a file. A band with distances alone is a level set, as far as it is one.
GridOutput::NewGrid NewGridFor(VdbFormat format, const VoxelizeRequest& request) {
  const std::vector<Field>& fields = request.fields;
  if (!NeedsOpenVdb(format, fields))
    return [](const Vdb*, const Accepted& accepted) { return NewBrickGrid(accepted.grid); };
  if (fields.empty()) return [](const Vdb* vdb, const Accepted& accepted) { return vdb->NewVoxelGrid(accepted.grid); };
  const auto* const band = std::get_if<Band>(&request.set);
  if (band == nullptr || fields != std::vector<Field>{Field::kDistance}) {
    return [fields](const Vdb* vdb, const Accepted& accepted) {
      return vdb->NewFieldGrids(accepted.grid, fields, accepted.fraction_labels, accepted.neighbors);
    };
  }
  const bool whole = !request.region && !request.bounds && !request.shard;
  return [band = *band, is_signed = request.signed_distance, whole](const Vdb* vdb, const Accepted& accepted) {
    const GridTransform& grid = accepted.grid;
    const double width = band.in_voxels ? band.width * grid.voxel_size : band.width;
    return vdb->NewDistanceGrid(grid, width, is_signed, whole);
  };
}

template <VdbFormat format>
std::unique_ptr<Output> NewVdbOutput(std::unique_ptr<AtomicFile> file, const VoxelizeRequest& request,
                                     const OutputOptions& options) {
  return std::make_unique<GridOutput>(std::move(file), format, request, options, NewGridFor(format, request));
}

std::unique_ptr<Output> NewPngOutput(std::unique_ptr<AtomicFile> file, const VoxelizeRequest& request,
                                     const OutputOptions& options) {
  return NewPictureOutput(std::move(file), request, options.picture_up);
}

template <const char* extension>
std::unique_ptr<Output> NewTable(std::unique_ptr<AtomicFile> file, const VoxelizeRequest& request,
                                 const OutputOptions&) {
  return NewTableOutput(extension, std::move(file), request.fields);
}

std::unique_ptr<Output> NewHtmlOutput(std::unique_ptr<AtomicFile> file, const VoxelizeRequest& request,
                                      const OutputOptions& options) {
  const auto open = [request, options](std::unique_ptr<AtomicFile> vdb) {
    return NewVdbOutput<VdbFormat::kOpenVdb>(std::move(vdb), request, options);
  };
  return NewPageOutput(std::move(file), options, open);
}

std::unique_ptr<Output> NewFacetOutput(std::unique_ptr<AtomicFile> file, const VoxelizeRequest& request,
                                       const OutputOptions&) {
  return NewGlbOutput(std::move(file), request.fields);
}

std::unique_ptr<Output> NewNpyOutput(std::unique_ptr<AtomicFile> file, const VoxelizeRequest& request,
                                     const OutputOptions& options) {
  return options.dense_npy ? NewDenseNpyOutput(std::move(file), request.fields, options.shape)
                           : NewTableOutput(".npy", std::move(file), request.fields);
}

std::unique_ptr<Output> NewArchiveOutput(std::unique_ptr<AtomicFile> file, const VoxelizeRequest& request,
                                         const OutputOptions& options) {
  return NewNpzOutput(std::move(file), request.fields, options.shape);
}

std::unique_ptr<Output> NewCubeOutput(std::unique_ptr<AtomicFile> file, const VoxelizeRequest&,
                                      const OutputOptions& options) {
  return NewBinvoxOutput(std::move(file), options.shape);
}

std::unique_ptr<Output> NewSceneOutput(std::unique_ptr<AtomicFile> file, const VoxelizeRequest& request,
                                       const OutputOptions&) {
  return NewVoxOutput(std::move(file), request.fields);
}

std::unique_ptr<Output> NewCellOutput(std::unique_ptr<AtomicFile> file, const VoxelizeRequest& request,
                                      const OutputOptions& options) {
  return NewVtiOutput(std::move(file), request.fields, options.shape);
}

template <VtuForm form>
std::unique_ptr<Output> NewGridOfCells(std::unique_ptr<AtomicFile> file, const VoxelizeRequest& request,
                                       const OutputOptions&) {
  return NewVtuOutput(std::move(file), request.fields, form);
}

template <std::unique_ptr<Output> (*new_output)(std::unique_ptr<AtomicFile>, const std::vector<Field>&)>
std::unique_ptr<Output> NewLinkList(std::unique_ptr<AtomicFile> file, const VoxelizeRequest& request,
                                    const OutputOptions&) {
  return new_output(std::move(file), request.fields);
}

template <ImageFormat format>
std::unique_ptr<Output> NewImage(std::unique_ptr<AtomicFile> file, const VoxelizeRequest& request,
                                 const OutputOptions& options) {
  return NewImageOutput(std::move(file), format, request.fields, options.shape);
}

using NewOutput = std::unique_ptr<Output> (*)(std::unique_ptr<AtomicFile>, const VoxelizeRequest&,
                                              const OutputOptions&);

// The fields that a format holds or shows.
enum class Holds {
  kNone,
  kPainted,  // one that gives each voxel a color: color, material, or part
  kOne,
  kOneType,  // all, if they have one type of numbers
  kLinks,    // those of links, and nothing without one
  kAll,
};

struct Format {
  const char *extension, *what;
  NewOutput open;
  Holds holds;
  bool is_placed = true;    // it tells where in the world the voxels are
  bool by_openvdb = false;  // a .html is made of a .vdb, which is read
};

constexpr char kLinksCsv[] = ".links.csv", kLinksNpz[] = ".links.npz", kCellsVtu[] = ".cells.vtu";
constexpr char kVdb[] = ".vdb", kCsv[] = ".csv", kNpy[] = ".npy", kPly[] = ".ply", kMhd[] = ".mhd",
               kNiiGz[] = ".nii.gz";

constexpr Format kFormats[] = {
    {kVdb, "OpenVDB", NewVdbOutput<VdbFormat::kOpenVdb>, Holds::kAll},
    {".nvdb", "NanoVDB", NewVdbOutput<VdbFormat::kNanoVdb>, Holds::kAll, /*is_placed=*/true, /*by_openvdb=*/true},
    {kCsv, "table", NewTable<kCsv>, Holds::kAll},
    {kNpy, "NumPy", NewNpyOutput, Holds::kAll, /*is_placed=*/false},
    {".npz", "NumPy, dense and placed", NewArchiveOutput, Holds::kAll},
    {kPly, "points", NewTable<kPly>, Holds::kAll},
    {".png", "picture", NewPngOutput, Holds::kAll, /*is_placed=*/false},
    {".html", "page", NewHtmlOutput, Holds::kAll, /*is_placed=*/true, /*by_openvdb=*/true},
    {".glb", "surface of cells", NewFacetOutput, Holds::kPainted},
    {".binvox", "binvox", NewCubeOutput, Holds::kNone},
    {".vox", "MagicaVoxel", NewSceneOutput, Holds::kPainted, /*is_placed=*/false},
    {".vti", "VTK, cells of a box", NewCellOutput, Holds::kAll},
    {".vtu", "VTK, points", NewGridOfCells<VtuForm::kPoints>, Holds::kAll},
    {kCellsVtu, "VTK, Voronoi cells", NewGridOfCells<VtuForm::kCells>, Holds::kAll},
    {".h5", "HDF5", NewHdf5Output, Holds::kAll},
    {kLinksCsv, "table of links", NewLinkList<NewLinkTableOutput>, Holds::kLinks},
    {kLinksNpz, "NumPy, arrays of links", NewLinkList<NewLinkArrayOutput>, Holds::kLinks},
    {".nrrd", "NRRD", NewImage<ImageFormat::kNrrd>, Holds::kOneType},
    {".mha", "MetaImage", NewImage<ImageFormat::kMetaImage>, Holds::kOneType},
    {kMhd, "MetaImage with a .raw beside it", NewImage<ImageFormat::kMetaPair>, Holds::kOneType},
    {".nii", "NIfTI", NewImage<ImageFormat::kNifti>, Holds::kOne},
    {kNiiGz, "NIfTI, compressed", NewImage<ImageFormat::kNiftiGzip>, Holds::kOne},
};

Holds WhatHolds(const Format& format, const OutputOptions& options) {
  return options.dense_npy && format.extension == kNpy ? Holds::kOne : format.holds;
}

bool CanHold(const Format& format, const std::vector<Field>& fields, const OutputOptions& options) {
  const Holds holds = WhatHolds(format, options);
  if (holds == Holds::kLinks) {
    const auto is_of_links = [](Field field) { return FactsOf(field).is_of_links(); };
    return !fields.empty() && std::all_of(fields.begin(), fields.end(), is_of_links);
  }
  if (fields.empty() || holds == Holds::kAll) return true;
  if (holds == Holds::kOneType) {
    const auto differs = [&fields](Field field) { return FactsOf(field).type != FactsOf(fields.front()).type; };
    return std::none_of(fields.begin(), fields.end(), differs);
  }
  if (fields.size() > 1 || holds == Holds::kNone) return false;
  return holds == Holds::kOne || DefaultColorBy({fields}) != ColorBy::kNone;
}

// Returns the format of the path's extension, or nullptr.
const Format* FormatOf(const std::string& path) {
  const auto has_extension = [extension = ExtensionOf(path)](const Format& format) {
    return extension == format.extension;
  };
  const auto* const format = std::find_if(std::begin(kFormats), std::end(kFormats), has_extension);
  return format == std::end(kFormats) ? nullptr : format;
}

std::vector<Field> FieldsIn(const std::string& path, const std::vector<Field>& fields, const OutputOptions& options) {
  return options.array && IsLimited(path, options) ? *options.array : fields;
}

// Returns how --array makes the file hold some of the fields that it cannot hold together, or "".
const char* WhatArraySelects(const std::string& path, const std::vector<Field>& fields, const OutputOptions& options) {
  if (options.array || !IsLimited(path, options)) return "";
  const auto fits = [&](Field field) { return CanHold(*FormatOf(path), {field}, options); };
  const bool any_fits = std::any_of(fields.begin(), fields.end(), fits);
  if (any_fits) return ", and --array selects some for this file";
  return CanHold(*FormatOf(path), {}, options) ? ", and --array none leaves them out of this file" : "";
}

}  // namespace

std::string ExtensionOf(const std::string& path) {
  for (const char* const twofold : {kNiiGz, kLinksCsv, kLinksNpz, kCellsVtu}) {
    if (absl::EndsWithIgnoreCase(path, twofold)) return twofold;
  }
  return absl::AsciiStrToLower(std::filesystem::path(path).extension().string());
}

std::string JoinNames(const std::vector<Field>& fields) {
  return absl::StrJoin(fields, ",", [](std::string* out, Field field) { *out += NameOf(field); });
}

bool HasExtension(const std::string& path, const std::vector<std::string>& extensions) {
  return std::find(extensions.begin(), extensions.end(), ExtensionOf(path)) != extensions.end();
}

const std::vector<std::string>& OutputExtensions() {
  static const auto* const kExtensions = [] {
    auto* const extensions = new std::vector<std::string>;
    for (const Format& format : kFormats) extensions->push_back(format.extension);
    return extensions;
  }();
  return *kExtensions;
}

const std::vector<std::string>& ShapedExtensions() {
  static const auto* const kExtensions =
      new std::vector<std::string>{kNpy, ".npz", ".binvox", ".vti", ".nrrd", ".mha", kMhd, ".nii", kNiiGz};
  return *kExtensions;
}

const std::vector<std::string>& LimitedExtensions() {
  static const auto* const kExtensions = [] {
    auto* const extensions = new std::vector<std::string>;
    for (const Format& format : kFormats) {
      if (WhatHolds(format, {.dense_npy = true}) != Holds::kAll) extensions->push_back(format.extension);
    }
    return extensions;
  }();
  return *kExtensions;
}

bool IsLimited(const std::string& path, const OutputOptions& options) {
  const Format* const format = FormatOf(path);
  return format != nullptr && WhatHolds(*format, options) != Holds::kAll;
}

std::string WhyNotHeld(const std::string& path, const std::vector<Field>& fields, const OutputOptions& options) {
  const std::vector<Field> in_file = FieldsIn(path, fields, options);
  std::vector<std::string> able;
  for (const Format& format : kFormats) {
    if (CanHold(format, in_file, options)) able.emplace_back(format.extension);
  }
  if (HasExtension(path, able)) return "";
  const std::string held = in_file.empty() ? "voxels without links" : JoinNames(in_file);
  return absl::StrCat("cannot hold ", held, "; ", absl::StrJoin(able, " "), " can",
                      WhatArraySelects(path, fields, options));
}

std::vector<std::pair<std::string, std::string>> StreamedFormats() {
  std::vector<std::pair<std::string, std::string>> formats;
  for (const Format& format : kFormats) {
    if (format.extension != kMhd) formats.emplace_back(format.extension + 1, format.what);
  }
  return formats;
}

std::optional<Warning> WarningOfPlace(const std::vector<std::string>& paths) {
  const auto is_placed = [](const std::string& path) {
    const Format* const format = FormatOf(path);
    return format != nullptr && format->is_placed;
  };
  const auto npy =
      std::find_if(paths.begin(), paths.end(), [](const auto& path) { return HasExtension(path, {kNpy}); });
  if (npy == paths.end() || std::any_of(paths.begin(), paths.end(), is_placed)) return std::nullopt;
  return Warning{"NO_TRANSFORM", absl::StrCat(*npy, " does not tell where its voxels are in the world; a .npz does"),
                 *npy};
}

absl::StatusOr<std::unique_ptr<Output>> OpenOutput(const std::string& path, const VoxelizeRequest& request,
                                                   const OutputOptions& options) {
  const Format* const format = FormatOf(path);
  if (format == nullptr) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": extension \"", ExtensionOf(path), "\" is not one of ",
                                                   absl::StrJoin(OutputExtensions(), " ")));
  }
  const std::string why_not = WhyNotHeld(path, request.fields, options);
  if (!why_not.empty()) return absl::InvalidArgumentError(absl::StrCat(path, ": ", why_not));
  VoxelizeRequest of_file = request;
  of_file.fields = FieldsIn(path, request.fields, options);
  const bool is_with_fields = format->extension == kVdb && NeedsOpenVdb(VdbFormat::kOpenVdb, of_file.fields);
  if (format->by_openvdb || is_with_fields) {
    if (auto status = Vdb::Prepare(); !status.ok()) return status;
  }
  auto file = AtomicFile::Create(path, AtomicFile::Form::kUnnamed, options.cancellation);
  if (!file.ok()) return file.status();
  return format->open(*std::move(file), of_file, options);
}

}  // namespace latvox::client
