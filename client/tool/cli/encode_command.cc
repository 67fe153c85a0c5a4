#include "client/tool/cli/encode_command.h"

#include <memory>
#include <utility>
#include <variant>

#include "absl/strings/str_cat.h"
#include "client/mesh/mesh_encoder.h"
#include "client/mesh/raw_mesh.h"
#include "client/mesh_files/mesh_file.h"
#include "client/tool/cli/abandoned_work.h"
#include "client/tool/cli/common_options.h"
#include "client/tool/cli/progress_bar.h"
#include "client/tool/cli/warnings.h"
#include "client/tool/output/atomic_file.h"

namespace latvox::client {
namespace {

// A Draco stream is decoded, because it may have attributes besides positions, or be quantized here.
absl::StatusOr<Mesh> ReadMesh(const MeshSource& source) {
  auto read = ReadMeshSource(source);
  if (!read.ok()) return read.status();
  if (auto* mesh = std::get_if<Mesh>(&*read)) return std::move(*mesh);
  return ParseMeshFile(source.paths[0], std::get<std::string>(*read), MeshFormat::kDraco);
}

}  // namespace

void AddEncodeOptions(CommandParser& command, EncodeWords& words) {
  command.Add({MeshRow(words.mesh),
               OutputRow({".drc"}, words.outputs, /*several=*/false),
               {.names = "--quantization",
                .target = &words.quantization,
                .help = "Bits of a position's coordinate; 0 is lossless",
                .value = "BITS",
                .checks = {Whole(0, kMaxQuantizationBits)},
                .standard = "0"}});
  command.Add(MeshRows(words));
}

MeshSource Interpret(const EncodeWords& words) {
  if (words.outputs.size() != 1) Refuse("--out: one file, not ", words.outputs.size());
  MeshSource source = words.mesh;
  InterpretMesh(words, source);
  CheckMeshPaths(source, words.outputs);
  return source;
}

absl::StatusOr<std::string> RunEncode(const EncodeWords& words, const MeshSource& source,
                                      const Cancellation& cancellation) {
  const auto file = AtomicFile::Create(words.outputs[0]);
  if (!file.ok()) return file.status();
  CallOptions call;
  call.cancellation = cancellation;
  auto read = DoAbandonably([source] { return ReadMesh(source); }, call);
  if (!read.ok()) return read.status();
  const auto mesh = std::make_shared<const Mesh>(*std::move(read));
  ProgressBar bar;
  const auto say = [&bar](const std::string& line) { bar.Say("latvox: " + line); };
  constexpr int kFineBits = 20;  // half of a step of 2048 voxels' snapping
  std::vector<Warning> warnings = mesh->warnings;
  if (auto rounding = WarningOfRounding(*mesh, words.quantization > 0 ? words.quantization : kFineBits)) {
    warnings.push_back(*std::move(rounding));
  }
  if (auto status = Warn(warnings, words.strict, say); !status.ok()) return status;
  const auto encode = [mesh, bits = words.quantization] { return EncodeMesh(*mesh, bits); };
  const auto encoded = DoAbandonably(encode, call);
  if (!encoded.ok()) return encoded.status();
  if (auto status = (*file)->Append(encoded->drc); !status.ok()) return status;
  if (auto status = (*file)->Sync(); !status.ok()) return status;
  if (cancellation.cancelled()) return absl::CancelledError("cancelled");
  if (auto status = (*file)->Commit(); !status.ok()) return status;
  const std::string positions =
      words.quantization == 0 ? "lossless" : absl::StrCat("positions of ", words.quantization, " bits");
  return absl::StrCat(NameOf(source), ": ", mesh->triangles.size(),
                      mesh->triangles.size() == 1 ? " triangle" : " triangles", "\nwrote ", words.outputs[0], ", ",
                      encoded->drc.size(), " bytes, ", positions, "\n");
}

}  // namespace latvox::client
