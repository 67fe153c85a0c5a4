#include "client/tool/output/output.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/internal/file_error.h"
#include "client/tool/output/atomic_file.h"
#include "client/tool/output/box_output.h"
#include "client/tool/output/dense_output.h"
#include "client/tool/output/grid_output.h"
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
#include "client/tool/vdb/vdb.h"
#include "latvox/stretched.h"

namespace latvox::client {
namespace {

template <VdbFormat format>
std::unique_ptr<Output> NewVdbOutput(std::unique_ptr<AtomicFile> file, const VoxelizeRequest& request,
                                     const OutputOptions& options) {
  return NewGridOutput(std::move(file), format, request, options);
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

// The cells that a format holds, and what the refusal of others says.
struct CellKind {
  bool (*includes)(const Basis& basis);
  const char* only;
};

constexpr CellKind kCubes = {IsCubic, kCubesOnly}, kBoxes = {IsAlongAxes, kBoxesOnly};
constexpr const CellKind* kAnyCells = nullptr;

struct Format {
  const char *extension, *what;
  NewOutput open;
  Holds holds;
  const CellKind* cells = kAnyCells;
  bool is_placed = true;    // it tells where in the world the voxels are
  bool by_openvdb = false;  // a .html is made of a .vdb, which is read
};

constexpr char kLinksCsv[] = ".links.csv", kLinksNpz[] = ".links.npz", kCellsVtu[] = ".cells.vtu";
constexpr char kVdb[] = ".vdb", kCsv[] = ".csv", kNpy[] = ".npy", kPly[] = ".ply", kMhd[] = ".mhd",
               kNiiGz[] = ".nii.gz";

constexpr Format kFormats[] = {
    {kVdb, "OpenVDB", NewVdbOutput<VdbFormat::kOpenVdb>, Holds::kAll},
    {".nvdb", "NanoVDB", NewVdbOutput<VdbFormat::kNanoVdb>, Holds::kAll, kAnyCells, /*is_placed=*/true,
     /*by_openvdb=*/true},
    {kCsv, "table", NewTable<kCsv>, Holds::kAll},
    {kNpy, "NumPy", NewNpyOutput, Holds::kAll, kAnyCells, /*is_placed=*/false},
    {".npz", "NumPy, dense and placed", NewArchiveOutput, Holds::kAll},
    {kPly, "points", NewTable<kPly>, Holds::kAll},
    {".png", "picture", NewPngOutput, Holds::kAll, kAnyCells, /*is_placed=*/false},
    {".html", "page", NewHtmlOutput, Holds::kAll, kAnyCells, /*is_placed=*/true, /*by_openvdb=*/true},
    {".glb", "surface of cells", NewFacetOutput, Holds::kPainted},
    {".binvox", "binvox", NewCubeOutput, Holds::kNone, &kCubes},
    {".vox", "MagicaVoxel", NewSceneOutput, Holds::kPainted, &kCubes, /*is_placed=*/false},
    {".vti", "VTK, cells of a box", NewCellOutput, Holds::kAll, &kBoxes},
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

bool HoldsFields(const Format& format, const std::vector<Field>& fields, const OutputOptions& options) {
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

// Returns the fields that a file of the format gets.
std::vector<Field> FieldsIn(const Format& format, const std::vector<Field>& fields, const OutputOptions& options) {
  return options.array && WhatHolds(format, options) != Holds::kAll ? *options.array : fields;
}

bool CanHold(const Format& format, const ToHold& voxels, const OutputOptions& options) {
  if (format.cells != kAnyCells && !(voxels.basis && format.cells->includes(*voxels.basis))) return false;
  if (options.is_one_file && format.extension == kMhd) return false;
  return HoldsFields(format, FieldsIn(format, voxels.fields, options), options);
}

// Returns how --array makes the file hold some of the fields that it cannot hold together, or "".
const char* WhatArraySelects(const Format& format, const std::vector<Field>& fields, const OutputOptions& options) {
  if (options.array) return "";
  const auto fits = [&](Field field) { return HoldsFields(format, {field}, options); };
  const bool any_fits = std::any_of(fields.begin(), fields.end(), fits);
  if (any_fits) return ", and --array selects some for this file";
  return HoldsFields(format, {}, options) ? ", and --array none leaves them out of this file" : "";
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

std::vector<std::string> AbleFormats(const ToHold& voxels, const OutputOptions& options) {
  std::vector<std::string> able;
  for (const Format& format : kFormats) {
    if (CanHold(format, voxels, options)) able.emplace_back(format.extension);
  }
  return able;
}

std::optional<NotHeld> WhyNotHeld(const std::string& path, const ToHold& voxels, const OutputOptions& options) {
  const Format& format = *FormatOf(path);
  const std::string able = absl::StrJoin(AbleFormats(voxels, options), " ");
  if (format.cells != kAnyCells && voxels.basis && !format.cells->includes(*voxels.basis)) {
    return NotHeld{true, absl::StrCat(format.cells->only, "; ", able, " can hold these voxels"), able};
  }
  const std::vector<Field> in_file = FieldsIn(format, voxels.fields, options);
  if (HoldsFields(format, in_file, options)) return std::nullopt;
  const std::string held = in_file.empty() ? "voxels without links" : JoinNames(in_file);
  const std::string text =
      absl::StrCat("cannot hold ", held, "; ", able, " can", WhatArraySelects(format, voxels.fields, options));
  return NotHeld{false, text, able};
}

ToHold ToHoldOf(const VoxelizeRequest& request) {
  const auto* const basis = std::get_if<Basis>(&request.lattice);
  return {request.fields, basis != nullptr ? *basis : Stretched(std::get<NamedLattice>(request.lattice), {1, 1, 1})};
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
    const std::string all = absl::StrJoin(OutputExtensions(), " ");
    const std::string text = absl::StrCat(path, ": extension \"", ExtensionOf(path), "\" is not one of ", all);
    return WithFile(absl::InvalidArgumentError(text), "--out", path, all);
  }
  if (const auto not_held = WhyNotHeld(path, ToHoldOf(request), options)) {
    return WithFile(absl::InvalidArgumentError(absl::StrCat(path, ": ", not_held->text)), "--out", path,
                    not_held->able);
  }
  VoxelizeRequest of_file = request;
  of_file.fields = FieldsIn(*format, request.fields, options);
  const bool is_with_fields = format->extension == kVdb && NeedsOpenVdb(VdbFormat::kOpenVdb, of_file.fields);
  if (format->by_openvdb || is_with_fields) {
    if (auto status = Vdb::Prepare(); !status.ok()) return status;
  }
  auto file = AtomicFile::Create(path, AtomicFile::Form::kUnnamed, options.cancellation);
  if (!file.ok()) return file.status();
  return format->open(*std::move(file), of_file, options);
}

}  // namespace latvox::client
