// Measures decoding in a confined process beside decoding in this process: by a pool of decoder processes and by Draco,
// in turns.
//   draco_encoder -i bunny.obj -o bunny.drc --skip NORMAL
//   latvox_bench_decoders bunny.drc
#include <algorithm>
#include <chrono>
#include <fstream>
#include <future>
#include <iterator>
#include <string>
#include <vector>

#include "absl/strings/str_format.h"
#include "server/decode/decoder_pool.h"
#include "server/decode/draco_decoder.h"

namespace latvox {
namespace {

constexpr int kRounds = 60;

struct Times {
  std::vector<double> ms;
  double minimum() { return *std::min_element(ms.begin(), ms.end()); }
  double median() {
    std::nth_element(ms.begin(), ms.begin() + static_cast<ptrdiff_t>(ms.size() / 2), ms.end());
    return ms[ms.size() / 2];
  }
};

template <class F>
void Time(Times& times, const F& work) {
  const auto began = std::chrono::steady_clock::now();
  work();
  times.ms.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - began).count());
}

absl::StatusOr<DecodedMesh> DecodeThrough(DecoderPool& pool, const absl::Cord& bytes) {
  std::promise<absl::StatusOr<DecodedMesh>> result;
  pool.Start({bytes, {}, {}, {}}, {}, {}, [&](absl::StatusOr<DecodedMesh> mesh) { result.set_value(std::move(mesh)); });
  return result.get_future().get();
}

bool Measure(DecoderPool& pool, const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(file), {});
  const absl::Cord cord(bytes);
  const auto here = DecodeDraco(bytes, {});
  const auto there = DecodeThrough(pool, cord);
  if (!here.ok() || !there.ok()) {
    absl::FPrintF(stderr, "%s: %s\n", path, (here.ok() ? there : here).status().message());
    return false;
  }
  if (here->mesh.vertices != there->mesh.vertices || here->mesh.triangles != there->mesh.triangles) {
    absl::FPrintF(stderr, "%s: the meshes differ\n", path);
    return false;
  }
  Times in_process, isolated;
  for (int n = 0; n < kRounds; ++n) {
    Time(in_process, [&] { static_cast<void>(DecodeDraco(bytes, {})); });
    Time(isolated, [&] { static_cast<void>(DecodeThrough(pool, cord)); });
  }
  const double added = isolated.median() - in_process.median();
  absl::PrintF(
      "%s: %d triangles, %d bytes; in process %.2f ms (at best %.2f), isolated %.2f (%.2f): %+.2f ms, %+.1f %%\n", path,
      here->mesh.triangles.size(), bytes.size(), in_process.median(), in_process.minimum(), isolated.median(),
      isolated.minimum(), added, 100 * added / in_process.median());
  return true;
}

}  // namespace
}  // namespace latvox

int main(int argc, char** argv) {
  const auto pool = latvox::DecoderPool::Create({.program = LATVOXD, .processes = 1, .memory = latvox::kNoMemoryLimit});
  if (!pool.ok()) {
    absl::FPrintF(stderr, "latvox_bench_decoders: %s\n", pool.status().message());
    return 1;
  }
  bool good = argc > 1;
  for (int n = 1; n < argc; ++n) good &= latvox::Measure(**pool, argv[n]);
  return good ? 0 : 2;
}
