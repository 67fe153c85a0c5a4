#include "client/tool/cli/mesh_upload.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <variant>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "client/mesh/mesh_encoder.h"
#include "client/mesh/raw_mesh.h"
#include "client/mesh_files/mesh_file.h"
#include "client/mesh_files/mesh_source.h"
#include "client/tool/cli/abandoned_work.h"
#include "client/tool/cli/common_options.h"
#include "client/tool/cli/mesh_names.h"

namespace latvox::client {
namespace {

constexpr uint64_t kMostArrayBytes = uint64_t{1} << 30;  // of a mesh, on a server with default limits

// Estimates the voxels along the longest side of the mesh. In a basis of short and long vectors, counts along the short
// ones.
double VoxelsAlong(double side, const VoxelizeRequest& request) {
  double size = 1, shortest = 1;
  if (const Basis* basis = std::get_if<Basis>(&request.lattice)) {
    const auto& [a, b, c] = *basis;
    const double det =
        a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
    const auto length = [](const Vec3d& v) { return std::hypot(v[0], v[1], v[2]); };
    size = std::cbrt(std::abs(det));
    shortest = std::min({1.0, length(a) / size, length(b) / size, length(c) / size});
  }
  const double voxels = request.resolution ? *request.resolution : side / request.voxel_size.value_or(size) + 1;
  return voxels / shortest;
}

double MillisecondsSince(absl::Time start) { return absl::ToDoubleMilliseconds(absl::Now() - start); }

// A Draco stream is sent as it is. Only --weld-report needs to decode it here.
absl::StatusOr<MeshUpload> PrepareDraco(const VoxelizeOptions& options, const CallOptions& call, std::string drc) {
  if (options.upload == UploadForm::kRaw) {
    return ToStatus(UsageError("--upload: a .drc file is sent as it is, not raw", {"--upload", "raw"}));
  }
  MeshUpload upload{.bytes = std::move(drc)};
  if (options.quantization_bits) {
    upload.warnings.push_back(
        {"QUANTIZATION_IGNORED", "--quantization does not apply to .drc, which is sent as it is", "--quantization"});
  }
  if (!options.weld_report) return upload;
  const auto count = [path = options.mesh.paths[0], upload]() mutable -> absl::StatusOr<MeshUpload> {
    const auto mesh = ParseMeshFile(path, upload.bytes, MeshFormat::kDraco);
    if (!mesh.ok()) return mesh.status();
    upload.weld = Weld(*mesh);
    return upload;
  };
  return DoAbandonably(count, call);
}

bool NeedsOrder(const std::vector<Field>& fields) {
  return std::any_of(fields.begin(), fields.end(), [](Field field) { return FactsOf(field).needs_order(); });
}

// Returns whether the tool itself colors voxels, or leaves some out.
bool NeedsBaseColors(const Mesh& mesh, const VoxelizeOptions& options) {
  const auto has_image = [](const BaseColor& color) { return color.image != nullptr; };
  const std::vector<BaseColor>& all = mesh.base_colors.all;
  if (options.alpha_cutoff) return !all.empty();
  return options.mesh.base_colors && std::any_of(all.begin(), all.end(), has_image);
}

UploadForm ChooseForm(const Mesh& mesh, const VoxelizeOptions& options, bool has_network, int bits) {
  if (options.upload != UploadForm::kAuto) return options.upload;
  if (NeedsDoubles(mesh, bits) || NeedsOrder(options.request.fields) || NeedsBaseColors(mesh, options)) {
    return UploadForm::kRaw;
  }
  const bool is_rounded = options.quantization_bits.value_or(0) > 0;
  const bool fits = MostRawBytes(mesh, options.mesh.attributes) <= kMostArrayBytes;
  return is_rounded || has_network || !fits ? UploadForm::kDraco : UploadForm::kRaw;
}

absl::StatusOr<MeshUpload> Encode(const Mesh& mesh, UploadForm form, int bits, const std::vector<Field>& attributes) {
  if (form == UploadForm::kRaw) {
    RawMesh raw = ToRaw(mesh, attributes);
    return MeshUpload{.bytes = std::move(raw.bytes), .raw = std::move(raw.layout)};
  }
  auto encoded = EncodeMesh(mesh, bits, attributes);
  if (!encoded.ok()) return encoded.status();
  return MeshUpload{.bytes = std::move(encoded->drc)};
}

}  // namespace

absl::StatusOr<MeshUpload> PrepareUpload(const VoxelizeOptions& options, const MeshReader& read_mesh, bool has_network,
                                         const CallOptions& call,
                                         const std::function<void(const std::string& stage)>& on_stage) {
  const absl::Time start = absl::Now();
  on_stage(absl::StrCat("reading ", NameOf(options.mesh)));
  auto read = DoAbandonably(read_mesh, call);
  if (!read.ok()) return read.status();
  const double read_ms = MillisecondsSince(start);
  if (auto* drc = std::get_if<std::string>(&*read)) {
    auto upload = PrepareDraco(options, call, std::move(*drc));
    if (upload.ok()) upload->read_ms = read_ms;
    return upload;
  }
  const auto mesh = std::make_shared<Mesh>(std::get<Mesh>(*std::move(read)));
  on_stage(absl::StrCat("encoding ", mesh->triangles.size(), " triangles"));
  const int fine = AutoQuantizationBits(VoxelsAlong(LongestSide(*mesh), options.request));
  const int bits = options.quantization_bits.value_or(fine);
  const UploadForm form = ChooseForm(*mesh, options, has_network, bits);
  const bool colors = NeedsBaseColors(*mesh, options);
  if (colors && form == UploadForm::kDraco) {
    return ToStatus(UsageError("--upload: textures and opacity need raw; Draco changes the order of triangles"));
  }
  const absl::Time begin = absl::Now();
  const auto encode = [=, attributes = options.mesh.attributes, skip_bad = options.mesh.skip_bad,
                       weld = options.weld_report]() -> absl::StatusOr<MeshUpload> {
    auto upload = Encode(*mesh, form, bits, attributes);
    if (!upload.ok()) return upload;
    upload->read_ms = read_ms;
    upload->encode_ms = MillisecondsSince(begin);
    upload->skipped = mesh->skipped;
    upload->warnings = mesh->warnings;
    if (form == UploadForm::kDraco) {
      if (auto rounding = WarningOfRounding(*mesh, bits > 0 ? bits : fine)) upload->warnings.push_back(*rounding);
    }
    upload->names = NamesOf(*mesh, attributes);
    if (weld) upload->weld = Weld(*mesh);
    if (!colors) return upload;
    auto sampler = BaseColorSampler::Create(mesh, skip_bad, upload->warnings);
    if (!sampler.ok()) return sampler.status();
    upload->base_colors = std::make_shared<BaseColorSampler>(*std::move(sampler));
    return upload;
  };
  return DoAbandonably(encode, call);
}

}  // namespace latvox::client
